!! The Jacobian of the controlled stresses with respect to the free components of F, from DDSDDE.
module driver_jacobian
   use driver_kinds, only: dp
   use driver_tensors, only: determinant, inverse, symmetric_part, skew_part, strain_voigt, stress_matrix, &
      stress_voigt, times, trace, voigt_row, voigt_col
   use driver_material, only: point_response
   implicit none
   private
   public :: bordered_jacobian
contains
   !! d(residual)/d(unknowns) exactly from DDSDDE: for dF, L = dF F^-1, D = sym L, W = skew L,
   !! d sigma = DDSDDE:D + W sigma - sigma W - sigma tr D; d det F = det F tr D.
   pure function bordered_jacobian(response, free, rate, constrained) result(jacobian)
      type(point_response), intent(in) :: response
      integer, intent(in) :: free(:)                       !! unknown components of F
      real(dp), intent(in) :: rate(:)                      !! dF/dq of each
      logical, intent(in) :: constrained                   !! last row: det F, last column: the pressure
      real(dp), allocatable :: jacobian(:, :)
      real(dp) :: gradient(3, 3), f_inverse(3, 3), change(6)
      integer :: j, n, m
      n = size(free)
      m = merge(n + 1, n, constrained)
      allocate (jacobian(m, m), source=0.0_dp)
      f_inverse = inverse(response%f)
      do j = 1, n
         gradient = 0.0_dp
         gradient(voigt_row(free(j)), :) = rate(j)*f_inverse(voigt_col(free(j)), :)
         change = stress_rate(response, gradient)
         jacobian(:n, j) = change(free)
         if (constrained) jacobian(m, j) = determinant(response%f)*trace(gradient)
      end do
      if (constrained) jacobian(:n, m) = merge(1.0_dp, 0.0_dp, free <= 3)
   end function bordered_jacobian

   pure function stress_rate(response, gradient) result(rate)
      type(point_response), intent(in) :: response
      real(dp), intent(in) :: gradient(3, 3)               !! L
      real(dp) :: rate(6), spin(3, 3), stress(3, 3)
      spin = skew_part(gradient)
      stress = stress_matrix(response%stress)
      rate = matmul(response%ddsdde, strain_voigt(symmetric_part(gradient))) &
             + stress_voigt(times(spin, stress) - times(stress, spin)) - trace(gradient)*response%stress
   end function stress_rate
end module driver_jacobian
