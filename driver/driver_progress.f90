!! What the loops over steps and increments carry besides the material state.
module driver_progress
   use driver_kinds, only: dp, kind_held, kind_stress, outcome_converged, outcome_rounding, outcome_accuracy
   use driver_tensors, only: voigt_row, voigt_col
   use driver_case, only: load_step, control_settings, point_state
   use driver_material, only: point_response
   use driver_newton, only: increment_goal, newton_result
   use driver_stepping, only: step_sizes, sizes_of_step, size_after_success, accuracy_factor
   implicit none
   private
   public :: progress, begin_step, extrapolate_to, goal_of_increment, weigh_accuracy, accept

   type :: progress
      type(step_sizes) :: sizes
      real(dp) :: load_scale = 0.0_dp                      !! MPa
      real(dp) :: begin(9) = 0.0_dp                        !! controlled values at the start of the step
      real(dp) :: commanded(9) = 0.0_dp                    !! controlled values where the last step ended
      integer :: kind(9) = kind_held                       !! kinds of the last step
      real(dp) :: next_dt = 0.0_dp                         !! s
      real(dp) :: last_change(3, 3) = 0.0_dp               !! F increment of the last accepted increment
      real(dp) :: last_rate(6) = 0.0_dp                    !! its strain rate, 1/s
      real(dp) :: last_dt = 0.0_dp                         !! s; 0: nothing to extrapolate from
      real(dp) :: elapsed = 0.0_dp                         !! s, since the start of the step
      integer :: iterations = 0                            !! of the last accepted increment, as are the next three
      real(dp), allocatable :: residuals(:)
      type(point_state) :: before                          !! its start
      type(point_response) :: response                     !! its end
   end type progress
contains
   !! Ramps begin at the value last commanded, or at the actual value where the kind of control changed.
   pure subroutine begin_step(now, state, step, controls)
      type(progress), intent(inout) :: now
      type(point_state), intent(in) :: state
      type(load_step), intent(in) :: step
      type(control_settings), intent(in) :: controls
      real(dp) :: stress(9)
      integer :: i
      stress = [state%stress, 0.0_dp, 0.0_dp, 0.0_dp]
      stress(1:3) = stress(1:3) + state%pressure
      do i = 1, 9
         if (step%kind(i) /= kind_stress) then
            now%begin(i) = state%f(voigt_row(i), voigt_col(i))
         else if (now%kind(i) == kind_stress) then
            now%begin(i) = now%commanded(i)
         else
            now%begin(i) = stress(i)
         end if
      end do
      now%commanded = merge(now%begin, step%target, step%kind == kind_held)
      now%kind = step%kind
      now%sizes = sizes_of_step(controls, step%duration)
      now%next_dt = now%sizes%initial
      now%last_dt = 0.0_dp
      now%elapsed = 0.0_dp
   end subroutine begin_step

   !! Make the extrapolation of the first increment arrive at a given first guess.
   pure subroutine extrapolate_to(now, state, guess)
      type(progress), intent(inout) :: now
      type(point_state), intent(in) :: state
      real(dp), intent(in) :: guess(3, 3)
      now%last_dt = now%sizes%initial
      now%last_change = guess - state%f
   end subroutine extrapolate_to

   !! Deformation, targets and first guess at the end of an increment of size dt.
   pure function goal_of_increment(now, state, step, controls, dt, extrapolate) result(goal)
      type(progress), intent(in) :: now
      type(point_state), intent(in) :: state
      type(load_step), intent(in) :: step
      type(control_settings), intent(in) :: controls
      real(dp), intent(in) :: dt                           !! s
      logical, intent(in) :: extrapolate                   !! the last increment, for the first guess
      type(increment_goal) :: goal
      real(dp) :: fraction, value(9)
      integer :: i
      fraction = (now%elapsed + dt)/step%duration
      value = now%begin + (now%commanded - now%begin)*fraction
      if (step%instant .or. fraction >= 1.0_dp) value = now%commanded
      goal%dt = dt
      goal%load_scale = now%load_scale
      goal%stress_controlled = step%kind(:6) == kind_stress
      goal%stress_target = value(:6)
      goal%constrained = multiplier_active(controls, state)
      goal%f_guess = state%f
      if (extrapolate .and. now%last_dt > 0.0_dp) &
         goal%f_guess = state%f + now%last_change*(dt/now%last_dt)
      do i = 1, 9
         if (step%kind(i) /= kind_stress) goal%f_guess(voigt_row(i), voigt_col(i)) = value(i)
      end do
   end function goal_of_increment

   pure logical function multiplier_active(controls, state)
      type(control_settings), intent(in) :: controls
      type(point_state), intent(in) :: state
      multiplier_active = controls%incompressible
      if (multiplier_active .and. controls%release_statev > 0) &
         multiplier_active = state%statev(controls%release_statev) < 0.5_dp
   end function multiplier_active

   !! The strain tolerance's opinion of a converged attempt; it may reject it.
   pure subroutine weigh_accuracy(controls, now, dt, result, accuracy)
      type(control_settings), intent(in) :: controls
      type(progress), intent(in) :: now
      real(dp), intent(in) :: dt
      type(newton_result), intent(inout) :: result
      real(dp), intent(out) :: accuracy                    !! factor for the next size; huge: no opinion
      real(dp) :: strain_error
      accuracy = huge(1.0_dp)
      if (.not. controls%strain_tolerance > 0.0_dp .or. .not. now%last_dt > 0.0_dp) return
      if (result%outcome /= outcome_converged .and. result%outcome /= outcome_rounding) return
      call accuracy_factor(controls, result%response%dstran, now%last_rate, dt, strain_error, accuracy)
      if (controls%reject_factor > 0.0_dp .and. dt > now%sizes%minimum .and. &
          strain_error > controls%reject_factor*controls%strain_tolerance) result%outcome = outcome_accuracy
   end subroutine weigh_accuracy

   subroutine accept(step, controls, goal, result, accuracy, state, now)
      type(load_step), intent(in) :: step
      type(control_settings), intent(in) :: controls
      type(increment_goal), intent(in) :: goal
      type(newton_result), intent(in) :: result
      real(dp), intent(in) :: accuracy
      type(point_state), intent(inout) :: state
      type(progress), intent(inout) :: now
      if (goal%dt >= step%duration - now%elapsed) then
         now%elapsed = step%duration
      else
         now%elapsed = now%elapsed + goal%dt
      end if
      call size_after_success(now%sizes, controls, goal%dt, result%iterations, result%response%pnewdt, accuracy, &
                              now%next_dt)
      now%last_change = result%response%f - state%f
      now%last_dt = goal%dt
      now%last_rate = result%response%dstran/goal%dt
      now%before = state
      now%residuals = result%residuals
      now%response = result%response
      now%iterations = result%iterations
      state%f = result%response%f
      state%stress = result%response%stress
      state%pressure = result%pressure
      state%stran = result%response%stran
      state%statev = result%response%statev
      state%energy = result%response%energy
      state%increment = state%increment + 1
   end subroutine accept
end module driver_progress
