!! What the loops over steps and increments carry besides the material state, and the sizes of increments: growth, cuts,
!! PNEWDT, strain tolerance, and the exact end of a step.
module driver_progress
   use driver_kinds, only: dp, kind_held, kind_stress, outcome_converged, outcome_rounding, outcome_accuracy, &
      outcome_pnewdt, pnewdt_untouched
   use driver_tensors, only: voigt_row, voigt_col
   use driver_case, only: load_step, control_settings, point_state
   use driver_material, only: point_response
   use driver_newton, only: increment_goal, newton_result
   implicit none
   private
   public :: step_sizes, progress, begin_step, goal_of_increment, weigh_accuracy, accept, size_to_end, size_after_failure

   type :: step_sizes
      real(dp) :: initial = 0.0_dp, minimum = 0.0_dp, maximum = 0.0_dp   !! s
      integer :: easy = 0                                                !! easy increments in a row
   end type step_sizes

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

   pure function sizes_of_step(controls, duration) result(sizes)
      type(control_settings), intent(in) :: controls
      real(dp), intent(in) :: duration                     !! s
      type(step_sizes) :: sizes
      sizes%maximum = merge(controls%maximum_increment, duration, controls%maximum_increment > 0.0_dp)
      sizes%initial = merge(controls%initial_increment, 0.01_dp*duration, controls%initial_increment > 0.0_dp)
      sizes%minimum = merge(controls%minimum_increment, 1.0e-9_dp*duration, controls%minimum_increment > 0.0_dp)
      sizes%maximum = min(sizes%maximum, duration)
      sizes%initial = min(sizes%initial, sizes%maximum)
      sizes%minimum = min(sizes%minimum, sizes%initial)
   end function sizes_of_step

   !! The step's end is hit exactly, and no sliver is left before it.
   pure real(dp) function size_to_end(wanted, remaining)
      real(dp), intent(in) :: wanted, remaining            !! s
      size_to_end = wanted
      if (wanted*(1.0_dp + 1.0e-6_dp) >= remaining) size_to_end = remaining
   end function size_to_end

   pure subroutine size_after_success(sizes, controls, dt, iterations, pnewdt, accuracy, next)
      type(step_sizes), intent(inout) :: sizes
      type(control_settings), intent(in) :: controls
      real(dp), intent(in) :: dt                           !! s, of the increment just accepted
      integer, intent(in) :: iterations
      real(dp), intent(in) :: pnewdt                       !! as the UMAT left it
      real(dp), intent(in) :: accuracy                     !! factor of the strain tolerance; huge: no opinion
      real(dp), intent(out) :: next                        !! s
      logical :: easy, opinion
      real(dp) :: factor
      easy = iterations <= controls%easy_iterations
      sizes%easy = merge(sizes%easy + 1, 0, easy)
      factor = 1.0_dp
      if (sizes%easy >= controls%easy_in_a_row) factor = controls%growth
      opinion = pnewdt > 1.0_dp .and. pnewdt < 1.0e-3_dp*pnewdt_untouched
      if (opinion .and. easy) factor = pnewdt
      if (accuracy < huge(1.0_dp)) then
         factor = merge(accuracy, min(1.0_dp, accuracy), easy)
         if (opinion) factor = min(factor, pnewdt)
      end if
      next = max(sizes%minimum, min(sizes%maximum, dt*factor))
   end subroutine size_after_success

   !! Size of the next attempt; below the minimum only if the failed one was at the minimum already.
   pure real(dp) function size_after_failure(sizes, controls, dt, outcome, factor) result(next)
      type(step_sizes), intent(in) :: sizes
      type(control_settings), intent(in) :: controls
      real(dp), intent(in) :: dt                           !! s, of the failed attempt
      integer, intent(in) :: outcome
      real(dp), intent(in) :: factor                       !! PNEWDT or the strain tolerance's factor
      if (outcome == outcome_pnewdt .or. outcome == outcome_accuracy) then
         next = dt*max(1.0e-9_dp, factor)
         if (dt > sizes%minimum*(1.0_dp + 1.0e-9_dp)) next = max(next, sizes%minimum)
      else
         next = dt*controls%cut
      end if
   end function size_after_failure

   !! Soft control of accuracy like CETOL: how the strain increment differs from the last rate's prediction.
   pure subroutine accuracy_factor(controls, dstran, last_rate, dt, strain_error, factor)
      type(control_settings), intent(in) :: controls
      real(dp), intent(in) :: dstran(6), last_rate(6), dt
      real(dp), intent(out) :: strain_error, factor
      strain_error = maxval(abs(dstran - last_rate*dt))
      factor = controls%growth
      if (strain_error > 0.0_dp) factor = 0.9_dp*sqrt(controls%strain_tolerance/strain_error)
      factor = max(0.25_dp, min(controls%growth, factor))
   end subroutine accuracy_factor
end module driver_progress
