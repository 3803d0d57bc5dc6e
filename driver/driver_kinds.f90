!! Number kinds and named constants that every driver module shares.
module driver_kinds
   use, intrinsic :: iso_c_binding, only: c_intptr_t
   use, intrinsic :: iso_fortran_env, only: real64
   implicit none
   private
   integer, parameter, public :: dp = real64
   integer, parameter, public :: address_kind = c_intptr_t

   !! what is prescribed of a component: nothing new (held), deformation gradient, or Cauchy stress
   integer, parameter, public :: kind_held = 0, kind_deformation = 1, kind_stress = 2

   !! how an attempt at an increment ended; the Python face reads the same numbers
   integer, parameter, public :: &
      outcome_converged = 0, outcome_max_iterations = 1, outcome_diverged = 2, outcome_not_finite = 3, &
      outcome_inverted = 4, outcome_singular = 5, outcome_pnewdt = 6, outcome_accuracy = 7, &
      outcome_stopped = 8, outcome_rounding = 9

   !! largest magnitude that "PNEWDT untouched" is told apart from an opinion of the UMAT
   real(dp), parameter, public :: pnewdt_untouched = 1.0e36_dp

   integer, parameter, public :: text_length = 2048
   public :: outcome_text
contains
   pure function outcome_text(outcome) result(text)
      integer, intent(in) :: outcome                 !! one of the outcome_ constants
      character(len=:), allocatable :: text
      select case (outcome)
      case (outcome_converged); text = 'converged'
      case (outcome_max_iterations); text = 'too many iterations'
      case (outcome_diverged); text = 'iterations diverge'
      case (outcome_not_finite); text = 'NaN or Inf from the UMAT'
      case (outcome_inverted); text = 'det F not positive'
      case (outcome_singular); text = 'singular Jacobian'
      case (outcome_pnewdt); text = 'PNEWDT asked for less'
      case (outcome_accuracy); text = 'strain tolerance exceeded'
      case (outcome_stopped); text = 'UMAT stopped the analysis'
      case (outcome_rounding); text = 'converged to rounding of F'
      case default; text = 'unknown outcome'
      end select
   end function outcome_text
end module driver_kinds
