!! Sizes of increments: growth, cuts, PNEWDT, strain tolerance, and the exact end of a step.
module driver_stepping
   use driver_kinds, only: dp, outcome_pnewdt, outcome_accuracy, pnewdt_untouched
   use driver_case, only: control_settings
   implicit none
   private
   public :: step_sizes, sizes_of_step, size_to_end, size_after_success, size_after_failure, accuracy_factor

   type :: step_sizes
      real(dp) :: initial = 0.0_dp, minimum = 0.0_dp, maximum = 0.0_dp   !! s
      integer :: easy = 0                                                !! easy increments in a row
   end type step_sizes
contains
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
end module driver_stepping
