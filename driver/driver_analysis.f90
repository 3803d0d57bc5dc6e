!! The whole analysis: steps, increments, attempts.
module driver_analysis
   use driver_kinds, only: dp, outcome_converged, outcome_rounding, outcome_accuracy, &
      outcome_pnewdt, outcome_stopped, outcome_text, text_length
   use driver_case, only: load_step, control_settings, point_state, material_point_case, largest_stress_target, &
      validate_case, with_temperatures
   use driver_material, only: material_point, connect
   use driver_newton, only: increment_goal, newton_result, solve_increment
   use driver_progress, only: step_sizes, progress, begin_step, goal_of_increment, weigh_accuracy, accept, size_to_end, &
      size_after_failure
   use driver_history, only: history_record, new_history, add_state, add_attempt, add_residuals
   use driver_tangent_check, only: check_tangent
   implicit none
   private
   public :: run_analysis
contains
   subroutine run_analysis(problem, history)
      type(material_point_case), intent(in) :: problem
      type(history_record), intent(out) :: history
      type(material_point) :: point
      type(progress) :: now
      type(point_state) :: state
      integer :: i
      history = new_history(problem%material%n_statev)
      history%message = validate_case(problem)
      if (len(history%message) > 0) return
      call connect(point, with_temperatures(problem))
      state = problem%start
      now%load_scale = problem%controls%load_scale
      if (.not. now%load_scale > 0.0_dp) now%load_scale = largest_stress_target(problem%steps)
      call add_state(history, state, 0.0_dp, 0)
      do i = 1, size(problem%steps)
         if (i > 1) then
            state%step = state%step + 1
            state%increment = 0
            state%step_time = 0.0_dp
         end if
         call begin_step(now, state, problem%steps(i), problem%controls)
         if (i == 1 .and. allocated(problem%first_guess)) then   ! the extrapolation arrives there
            now%last_dt = now%sizes%initial
            now%last_change = problem%first_guess - state%f
         end if
         call run_step(point, problem%steps(i), problem%controls, state, now, history)
         if (len(history%message) > 0) exit
      end do
      history%umat_calls = point%calls
      history%completed = len(history%message) == 0
   end subroutine run_analysis

   subroutine run_step(point, step, controls, state, now, history)
      type(material_point), intent(inout) :: point
      type(load_step), intent(in) :: step
      type(control_settings), intent(in) :: controls
      type(point_state), intent(inout) :: state
      type(progress), intent(inout) :: now
      type(history_record), intent(inout) :: history
      real(dp) :: time_before, step_time_before
      time_before = state%total_time
      step_time_before = state%step_time
      do while (now%elapsed < step%duration)
         if (history%n_states > controls%max_increments) then
            history%message = 'more than max_increments increments: raise it, the increments or the tolerances'
            return
         end if
         call run_increment(point, step, controls, state, now, history)
         if (len(history%message) > 0) return
         state%total_time = time_before + now%elapsed
         state%step_time = step_time_before + now%elapsed
         call record_state(point, controls, state, now, history)
      end do
   end subroutine run_step

   !! Attempts at one increment until one is accepted or none can be.
   subroutine run_increment(point, step, controls, state, now, history)
      type(material_point), intent(inout) :: point
      type(load_step), intent(in) :: step
      type(control_settings), intent(in) :: controls
      type(point_state), intent(inout) :: state
      type(progress), intent(inout) :: now
      type(history_record), intent(inout) :: history
      type(increment_goal) :: goal
      type(newton_result) :: result
      real(dp) :: wanted, accuracy
      logical :: accepted, extrapolate
      integer :: attempts
      attempts = 1
      extrapolate = controls%extrapolate
      wanted = now%next_dt
      do
         goal = goal_of_increment(now, state, step, controls, size_to_end(wanted, step%duration - now%elapsed), extrapolate)
         call solve_increment(point, state, goal, controls, result)
         if (passes_release(controls, goal, result)) call solve_released(point, state, controls, goal, result)
         call weigh_accuracy(controls, now, goal%dt, result, accuracy)
         accepted = result%outcome == outcome_converged .or. result%outcome == outcome_rounding
         call add_attempt(history, [real(dp) :: state%step, state%increment + 1, attempts, &
            result%iterations, [state%total_time, state%step_time] + merge(goal%dt, 0.0_dp, accepted), goal%dt, &
            result%outcome])
         if (accepted) exit
         wanted = size_after_failure(now%sizes, controls, goal%dt, result%outcome, &
                                     merge(accuracy, result%response%pnewdt, result%outcome == outcome_accuracy))
         history%message = why_no_retry(now%sizes, controls, result%outcome, attempts, wanted)
         if (len(history%message) > 0) then
            call describe_failure(state, goal, result, history)
            return
         end if
         attempts = attempts + 1
         now%sizes%easy = 0
         ! The last increment may have been a snap, whose rate no shorter increment takes back: begin without motion.
         if (result%outcome /= outcome_pnewdt .and. result%outcome /= outcome_accuracy) extrapolate = .false.
      end do
      call accept(step, controls, goal, result, accuracy, state, now)
      if (len(result%response%message) > 0 .and. len(history%warnings) < text_length) &
         history%warnings = history%warnings//result%response%message//new_line('a')
   end subroutine run_increment

   !! Whether the increment converged with det F = 1 although it ends where the constraint is released.
   pure logical function passes_release(controls, goal, result)
      type(control_settings), intent(in) :: controls
      type(increment_goal), intent(in) :: goal
      type(newton_result), intent(in) :: result
      passes_release = goal%constrained .and. controls%release_statev > 0 .and. &
         (result%outcome == outcome_converged .or. result%outcome == outcome_rounding)
      if (passes_release) passes_release = result%response%statev(controls%release_statev) >= 0.5_dp
   end function passes_release

   !! The same increment without the constraint, from where it ended with it; the iterations of both count.
   subroutine solve_released(point, state, controls, goal, result)
      type(material_point), intent(inout) :: point
      type(point_state), intent(in) :: state
      type(control_settings), intent(in) :: controls
      type(increment_goal), intent(inout) :: goal
      type(newton_result), intent(inout) :: result
      integer :: iterations
      iterations = result%iterations
      goal%constrained = .false.
      goal%f_guess = result%response%f
      call solve_increment(point, state, goal, controls, result)
      result%iterations = result%iterations + iterations
   end subroutine solve_released

   subroutine record_state(point, controls, state, now, history)
      type(material_point), intent(inout) :: point
      type(control_settings), intent(in) :: controls
      type(point_state), intent(in) :: state
      type(progress), intent(in) :: now
      type(history_record), intent(inout) :: history
      call add_state(history, state, now%last_dt, now%iterations)
      call add_residuals(history, now%residuals)
      if (controls%tangent_check_every <= 0) return
      if (modulo(history%n_states - 2, controls%tangent_check_every) == 0) &
         call check_tangent(point, now%before, now%response, now%last_dt, history)
   end subroutine record_state

   !! Why a failed attempt is the last one; empty: try again with the size wanted.
   pure function why_no_retry(sizes, controls, outcome, attempts, wanted) result(reason)
      type(step_sizes), intent(in) :: sizes
      type(control_settings), intent(in) :: controls
      integer, intent(in) :: outcome, attempts
      real(dp), intent(in) :: wanted                       !! s
      character(len=:), allocatable :: reason
      character(len=240) :: line
      line = ''
      if (outcome == outcome_stopped) then
         line = 'it cannot be repeated'
      else if (wanted < sizes%minimum*(1.0_dp - 1.0e-9_dp)) then
         write (line, '(a,es10.3,a,es10.3,a)') 'the next attempt would take', wanted, ' s, below the minimum of', &
            sizes%minimum, ' s: lower minimum_increment, or look at the loading'
      else if (attempts >= controls%max_attempts) then
         write (line, '(a,i0,a)') 'all ', attempts, ' attempts are used: allow more, or start with smaller increments'
      end if
      reason = trim(line)
   end function why_no_retry

   subroutine describe_failure(state, goal, result, history)
      type(point_state), intent(in) :: state
      type(increment_goal), intent(in) :: goal
      type(newton_result), intent(in) :: result
      type(history_record), intent(inout) :: history
      character(len=600) :: line
      history%failure%dt = goal%dt
      history%failure%f_end = result%response%f
      history%failure%outcome = result%outcome
      history%failure%f_guess = goal%f_guess
      history%failure%stress_controlled = goal%stress_controlled
      history%failure%stress_target = goal%stress_target
      history%failure%load_scale = goal%load_scale
      write (line, '(a,i0,a,i0,a,es12.5,a,es10.3,5a,i0,a,es10.3,a)') 'step ', state%step, ', increment ', &
         state%increment + 1, ' at total time', state%total_time, ' s, size', goal%dt, ' s: ', &
         outcome_text(result%outcome), '; ', history%message, ' (', result%iterations, ' iterations, residual', &
         result%residuals(size(result%residuals)), ' of the load scale)'
      history%message = trim(line)
      if (len(result%response%message) > 0) &
         history%message = history%message//new_line('a')//'UMAT: '//result%response%message
   end subroutine describe_failure
end module driver_analysis
