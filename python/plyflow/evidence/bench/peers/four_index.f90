!! DDSDDE as textbooks write it: 2 dS/dC as a tensor of four indices, Eq. 16, pushed forward by four sums over F and
!! completed by the Jaumann terms, Eq. 17.
subroutine four_index_tangent(f, c, c_inverse, c_rate, g, idle, slopes, dt, props, kappa, tau, jacobian, ddsdde)
   implicit none
   integer, parameter :: dp = kind(1.0d0)
   real(dp), intent(in) :: f(3, 3), c(3, 3), c_inverse(3, 3), c_rate(3, 3), g, idle, slopes(3, 3), dt, props(17), kappa
   real(dp), intent(in) :: tau(3, 3), jacobian
   real(dp), intent(out) :: ddsdde(6, 6)
   integer, parameter :: row(6) = [1, 2, 3, 1, 1, 2], column(6) = [1, 2, 3, 2, 3, 3]
   real(dp) :: material(3, 3, 3, 3), total
   integer :: i, j, k, l, p, q, r, s, ij, kl
   call material_tangent(c, c_inverse, c_rate, g*idle, slopes, dt, props, kappa, jacobian, material)
   do kl = 1, 6
      k = row(kl); l = column(kl)
      do ij = 1, 6
         i = row(ij); j = column(ij)
         total = 0
         do s = 1, 3
            do r = 1, 3
               do q = 1, 3
                  do p = 1, 3
                     total = total + f(i, p)*f(j, q)*f(k, r)*f(l, s)*material(p, q, r, s)
                  end do
               end do
            end do
         end do
         total = total + 0.5_dp*(delta(i, k)*tau(j, l) + delta(i, l)*tau(j, k) + delta(j, k)*tau(i, l) &
                                 + delta(j, l)*tau(i, k))
         ddsdde(ij, kl) = total/jacobian
      end do
   end do
contains
   pure real(dp) function delta(m, n)
      integer, intent(in) :: m, n
      delta = merge(1.0_dp, 0.0_dp, m == n)
   end function delta

   !! 2 dS/dC of elastic, volumetric and viscous part, MPa.
   subroutine material_tangent(c, c_inverse, c_rate, g, slopes, dt, props, kappa, jacobian, d)
      real(dp), intent(in) :: c(3, 3), c_inverse(3, 3), c_rate(3, 3), g, slopes(3, 3), dt, props(17), kappa, jacobian
      real(dp), intent(out) :: d(3, 3, 3, 3)
      real(dp) :: m(5), n(3), pressure_like, stiffening
      integer :: i, j, k, l
      call elastic_constants(props, m)
      n = [1.0_dp, 0.0_dp, 0.0_dp]
      ! J times the slope of the potential to J, and J times the derivative of that product.
      pressure_like = -m(1) + (m(3) + kappa)*(jacobian - 1)*jacobian + 0.5_dp*m(4)*(c(1, 1) - 1)
      stiffening = (m(3) + kappa)*(2*jacobian - 1)*jacobian
      do l = 1, 3
         do k = 1, 3
            do j = 1, 3
               do i = 1, 3
                  d(i, j, k, l) = stiffening*c_inverse(i, j)*c_inverse(k, l) &
                     - pressure_like*(c_inverse(i, k)*c_inverse(j, l) + c_inverse(i, l)*c_inverse(j, k)) &
                     + m(5)*n(i)*n(j)*n(k)*n(l) &
                     + m(4)*(n(i)*n(j)*c_inverse(k, l) + c_inverse(i, j)*n(k)*n(l)) &
                     - (m(1) - m(2))*(n(i)*delta(j, k)*n(l) + n(i)*delta(j, l)*n(k) &
                                      + n(j)*delta(i, k)*n(l) + n(j)*delta(i, l)*n(k)) &
                     + g*c_rate(i, j)*slopes(k, l) &
                     + g/dt*(delta(i, k)*delta(j, l) + delta(i, l)*delta(j, k))
               end do
            end do
         end do
      end do
   end subroutine material_tangent
end subroutine four_index_tangent
