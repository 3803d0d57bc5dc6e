!! Newton iterations of one increment: unknown are the components of F whose stress is prescribed, and the
!! pressure where incompressibility is exact.
module driver_newton
   use driver_kinds, only: dp, outcome_converged, outcome_max_iterations, outcome_diverged, outcome_not_finite, &
      outcome_inverted, outcome_singular, outcome_pnewdt, outcome_rounding
   use driver_tensors, only: determinant
   use driver_unknowns, only: unknown_set, unknowns_from_start, increments_of, deformation_at, sensitivity, &
      bordered_jacobian
   use driver_linear_solver, only: linear_factors, lu_factor, lu_solve
   use driver_power_step, only: power_step
   use driver_case, only: control_settings, point_state
   use driver_material, only: material_point, point_response, evaluate
   implicit none
   private
   real(dp), parameter :: volume_tolerance = 1.0e-13_dp
   public :: increment_goal, newton_result, solve_increment

   type :: increment_goal
      real(dp) :: dt = 0.0_dp                              !! s
      real(dp) :: f_guess(3, 3) = 0.0_dp                   !! prescribed components, and first guess of the others
      logical :: stress_controlled(6) = .false.
      real(dp) :: stress_target(6) = 0.0_dp                !! MPa
      logical :: constrained = .false.                     !! det F = 1 with the pressure as unknown
      real(dp) :: load_scale = 0.0_dp                      !! MPa; 0: take the largest current stress
   end type increment_goal

   type :: newton_result
      integer :: outcome = outcome_converged
      integer :: iterations = 0                            !! linear solutions; 1 where none was needed
      real(dp) :: pressure = 0.0_dp
      type(point_response) :: response
      real(dp), allocatable :: residuals(:)                !! relative to the load scale, one per evaluation
   end type newton_result

   !! The iterate: unknowns, what the UMAT says there, and the residual.
   type :: iterate
      real(dp), allocatable :: unknowns(:)                 !! q of the components of F, then the pressure
      real(dp), allocatable :: residual(:)                 !! MPa, then det F - 1
      type(point_response) :: response
      real(dp) :: measure = huge(1.0_dp)                   !! largest residual relative to the load scale
      real(dp) :: volume_error = 0.0_dp                    !! |det F - 1| where it is constrained
   end type iterate
contains
   subroutine solve_increment(point, start, goal, controls, result)
      type(material_point), intent(inout) :: point
      type(point_state), intent(in) :: start
      type(increment_goal), intent(in) :: goal
      type(control_settings), intent(in) :: controls
      type(newton_result), intent(out) :: result
      type(unknown_set) :: free
      type(iterate) :: current
      logical :: settled
      integer :: worse
      real(dp) :: last_measure
      free = unknowns_from_start(start%f, goal%stress_controlled)
      current%unknowns = increments_of(free, goal%f_guess)
      if (goal%constrained) current%unknowns = [current%unknowns, start%pressure]
      result%residuals = [real(dp) ::]
      worse = 0
      settled = .false.
      call assess(point, start, goal, free, current)
      do
         result%residuals = [result%residuals, current%measure]
         result%outcome = verdict(current, controls, settled, result%iterations, worse)
         if (result%outcome >= 0) exit
         last_measure = current%measure
         call improve(point, start, goal, controls, free, current, settled, result%outcome)
         if (result%outcome == outcome_singular) exit
         result%iterations = result%iterations + 1
         worse = merge(worse + 1, 0, current%measure >= last_measure .and. result%iterations > 3)
      end do
      result%iterations = max(1, result%iterations)
      result%response = current%response
      result%pressure = 0.0_dp
      if (goal%constrained) result%pressure = current%unknowns(size(free%index) + 1)
   end subroutine solve_increment

   !! The outcome if the iterations end here, -1 if they go on.
   pure integer function verdict(current, controls, settled, iterations, worse)
      type(iterate), intent(in) :: current
      type(control_settings), intent(in) :: controls
      logical, intent(in) :: settled                       !! the last correction was rounding of F
      integer, intent(in) :: iterations, worse
      verdict = -1
      if (current%response%outcome /= outcome_converged) then
         verdict = current%response%outcome
      else if (current%measure <= controls%residual_tolerance .and. &
               current%volume_error <= volume_tolerance) then
         verdict = outcome_converged
      else if (settled .and. current%measure <= controls%rounding_tolerance) then
         verdict = outcome_rounding
      else if (.not. current%measure < huge(1.0_dp)) then
         verdict = outcome_not_finite
      else if (iterations >= controls%max_iterations) then
         verdict = outcome_max_iterations
      else if (worse >= 6) then
         verdict = outcome_diverged
      end if
   end function verdict

   !! One Newton step, taken back in part while it makes things clearly worse. "Worse" is measured by the next
   !! correction with the same Jacobian, which does not depend on the units or stiffness of the equations.
   subroutine improve(point, start, goal, controls, free, current, settled, outcome)
      type(material_point), intent(inout) :: point
      type(point_state), intent(in) :: start
      type(increment_goal), intent(in) :: goal
      type(control_settings), intent(in) :: controls
      type(unknown_set), intent(in) :: free
      type(iterate), intent(inout) :: current
      logical, intent(out) :: settled
      integer, intent(out) :: outcome
      type(linear_factors) :: factors
      type(iterate) :: trial
      real(dp), allocatable :: correction(:), preimage(:), step(:)
      real(dp) :: fraction
      logical :: singular
      integer :: back_off, n
      n = size(free%index)
      settled = .false.
      outcome = outcome_singular
      call lu_factor(bordered_jacobian(current%response, free%index, sensitivity(free, current%unknowns), &
                                        goal%constrained), factors, singular)
      if (singular) return
      outcome = outcome_converged
      correction = -lu_solve(factors, current%residual)
      preimage = preimage_of_stress(factors, current, free%index, goal%constrained)
      do back_off = 0, 6
         fraction = 0.5_dp**back_off
         step = correction*fraction**2
         if (controls%power_newton) &
            step(:n) = power_step(current%unknowns(:n), correction(:n), preimage, fraction)
         call limit_step(controls, current%measure, n, step, settled)
         trial%unknowns = current%unknowns + step
         call assess(point, start, goal, free, trial)
         if (.not. controls%power_newton) exit
         if (.not. clearly_worse(factors, trial, n, norm2(correction(:n)))) exit
      end do
      current = trial
   end subroutine improve

   !! Bound the change of F, and make a step that would be lost in the rounding of F just large enough to be
   !! seen, since it would be tried for ever.
   pure subroutine limit_step(controls, measure, n, step, settled)
      type(control_settings), intent(in) :: controls
      real(dp), intent(in) :: measure
      integer, intent(in) :: n
      real(dp), intent(inout) :: step(:)
      logical, intent(out) :: settled                      !! the step is rounding of F
      real(dp) :: largest
      largest = max(tiny(1.0_dp), maxval(abs(step(:n))))
      settled = largest <= 4.0_dp*epsilon(1.0_dp)
      step = step*min(1.0_dp, controls%largest_correction/largest)
      if (settled .and. measure > controls%rounding_tolerance) step = step*(64.0_dp*epsilon(1.0_dp)/largest)
   end subroutine limit_step

   pure logical function clearly_worse(factors, trial, n, last_correction)
      type(linear_factors), intent(in) :: factors
      type(iterate), intent(in) :: trial
      integer, intent(in) :: n
      real(dp), intent(in) :: last_correction
      real(dp) :: next(size(trial%unknowns))
      clearly_worse = any(trial%response%outcome == [outcome_inverted, outcome_not_finite, outcome_pnewdt])
      if (clearly_worse .or. trial%response%outcome /= outcome_converged) return
      next = lu_solve(factors, trial%residual)
      clearly_worse = norm2(next(:n)) > 3.0_dp*last_correction
   end function clearly_worse

   !! Call the UMAT at the trial's unknowns and form the residual.
   subroutine assess(point, start, goal, free, trial)
      type(material_point), intent(inout) :: point
      type(point_state), intent(in) :: start
      type(increment_goal), intent(in) :: goal
      type(unknown_set), intent(in) :: free
      type(iterate), intent(inout) :: trial
      real(dp) :: f(3, 3), stress(6), scale
      f = deformation_at(free, trial%unknowns, goal%f_guess)
      call evaluate(point, start, f, goal%dt, trial%response)
      stress = trial%response%stress
      if (goal%constrained) stress(1:3) = stress(1:3) + trial%unknowns(size(free%index) + 1)
      scale = goal%load_scale
      if (.not. scale > 0.0_dp) scale = max(maxval(abs(stress)), tiny(1.0_dp))
      trial%residual = stress(free%index) - goal%stress_target(free%index)
      trial%measure = 0.0_dp
      if (size(free%index) > 0) trial%measure = maxval(abs(trial%residual))/scale
      if (.not. goal%constrained) return
      trial%residual = [trial%residual, determinant(f) - 1.0_dp]
      trial%volume_error = abs(determinant(f) - 1.0_dp)
      trial%measure = max(trial%measure, trial%volume_error)
   end subroutine assess

   !! z of K z = present stress of the free components: the increment divided by n if the stress is a power n of it.
   pure function preimage_of_stress(factors, current, free, constrained) result(preimage)
      type(linear_factors), intent(in) :: factors
      type(iterate), intent(in) :: current
      integer, intent(in) :: free(:)
      logical, intent(in) :: constrained
      real(dp) :: preimage(size(free)), solution(size(current%unknowns)), right_side(size(current%unknowns))
      integer :: n
      n = size(free)
      right_side = 0.0_dp
      right_side(:n) = current%response%stress(free)
      if (constrained) right_side(:n) = right_side(:n) + merge(current%unknowns(n + 1), 0.0_dp, free <= 3)
      solution = lu_solve(factors, right_side)
      preimage = solution(:n)
   end function preimage_of_stress
end module driver_newton
