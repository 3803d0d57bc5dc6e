!! DDSDDE by forward differences of the Kirchhoff stress: six stretching perturbations, six more evaluations of the law.
subroutine perturbed_tangent(f0, f1, dt, props, locked, tau, jacobian, ddsdde)
   implicit none
   integer, parameter :: dp = kind(1.0d0)
   real(dp), parameter :: size = 1.0e-8_dp                 !! of the strain: the root of the rounding unit
   real(dp), intent(in) :: f0(3, 3), f1(3, 3), dt, props(17), tau(3, 3), jacobian
   logical, intent(in) :: locked
   real(dp), intent(out) :: ddsdde(6, 6)
   integer, parameter :: row(6) = [1, 2, 3, 1, 1, 2], column(6) = [1, 2, 3, 2, 3, 3]
   real(dp) :: turned(3, 3), c(3, 3), c_inverse(3, 3), c_rate(3, 3), g, slopes(3, 3), scalars(8), s(3, 3), other(3, 3)
   logical :: fault
   integer :: i, k
   do k = 1, 6
      turned = f1
      turned(row(k), :) = turned(row(k), :) + 0.5_dp*size*f1(column(k), :)
      turned(column(k), :) = turned(column(k), :) + 0.5_dp*size*f1(row(k), :)
      call law_stress(f0, turned, dt, props, locked, c, c_inverse, c_rate, g, slopes, scalars, s, fault)
      call push_forward(turned, s, other)
      do i = 1, 6
         ddsdde(i, k) = (other(row(i), column(i)) - tau(row(i), column(i)))/(size*jacobian)
      end do
   end do
end subroutine perturbed_tangent
