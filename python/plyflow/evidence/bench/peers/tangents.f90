!! Two textbook ways to DDSDDE for the law of law.f90, and the UMAT that takes the one named by `way`.
module peer_tangents
   use peer_law
   implicit none
   integer, parameter :: row(6) = [1, 2, 3, 1, 1, 2], column(6) = [1, 2, 3, 2, 3, 3]
contains

   !! Forward differences of the Kirchhoff stress: six stretching perturbations, six more evaluations of the law.
   subroutine perturbed_tangent(f0, f1, dt, props, locked, in_plane, tau, jacobian, ddsdde)
      real(dp), parameter :: size = 1.0e-8_dp                 !! of the strain: the root of the rounding unit
      real(dp), intent(in) :: f0(3, 3), f1(3, 3), dt, props(n_props), in_plane, tau(3, 3), jacobian
      logical, intent(in) :: locked
      real(dp), intent(out) :: ddsdde(6, 6)
      real(dp) :: turned(3, 3), c(3, 3), c_inverse(3, 3), c_rate(3, 3), g, slopes(3, 3), scalars(8), s(3, 3), other(3, 3)
      logical :: fault
      integer :: i, k
      do k = 1, 6
         turned = f1
         turned(row(k), :) = turned(row(k), :) + 0.5_dp*size*f1(column(k), :)
         turned(column(k), :) = turned(column(k), :) + 0.5_dp*size*f1(row(k), :)
         call law_stress(f0, turned, dt, props, locked, in_plane, c, c_inverse, c_rate, g, slopes, scalars, s, fault)
         other = matmul(matmul(turned, s), transpose(turned))
         do i = 1, 6
            ddsdde(i, k) = (other(row(i), column(i)) - tau(row(i), column(i)))/(size*jacobian)
         end do
      end do
   end subroutine perturbed_tangent

   !! As textbooks write it: 2 dS/dC as a tensor of four indices, Eq. 16, pushed forward by four sums over F and completed
   !! by the Jaumann terms, Eq. 17.
   subroutine four_index_tangent(f, c, c_inverse, c_rate, g, slopes, dt, props, kappa, tau, jacobian, ddsdde)
      real(dp), intent(in) :: f(3, 3), c(3, 3), c_inverse(3, 3), c_rate(3, 3), g, slopes(3, 3), dt, props(n_props), kappa
      real(dp), intent(in) :: tau(3, 3), jacobian
      real(dp), intent(out) :: ddsdde(6, 6)
      real(dp) :: material(3, 3, 3, 3), total
      integer :: i, j, k, l, p, q, r, s, ij, kl
      call material_tangent(c, c_inverse, c_rate, g, slopes, dt, props, kappa, jacobian, material)
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
   end subroutine four_index_tangent

   !! 2 dS/dC of elastic, volumetric and viscous part, MPa.
   subroutine material_tangent(c, c_inverse, c_rate, g, slopes, dt, props, kappa, jacobian, d)
      real(dp), intent(in) :: c(3, 3), c_inverse(3, 3), c_rate(3, 3), g, slopes(3, 3), dt, props(n_props), kappa, jacobian
      real(dp), intent(out) :: d(3, 3, 3, 3)
      real(dp), parameter :: n(3) = [1.0_dp, 0.0_dp, 0.0_dp]
      real(dp) :: m(5), pressure_like, stiffening
      integer :: i, j, k, l
      m = elastic_constants(props)
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

   pure real(dp) function delta(m, n)
      integer, intent(in) :: m, n
      delta = merge(1.0_dp, 0.0_dp, m == n)
   end function delta
end module peer_tangents

subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, &
                dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, &
                dfgrd0, dfgrd1, noel, npt, layer, kspt, kstep, kinc)
   use peer_tangents
   implicit none
   character(len=*), parameter :: way = '@WAY@'
   character(len=80) :: cmname
   integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, kstep, kinc
   real(dp) :: stress(ntens), statev(nstatv), ddsdde(ntens, ntens), sse, spd, scd, rpl, ddsddt(ntens), drplde(ntens)
   real(dp) :: drpldt, stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(1), dpred(1), props(nprops)
   real(dp) :: coords(3), drot(3, 3), pnewdt, celent, dfgrd0(3, 3), dfgrd1(3, 3)
   real(dp) :: c(3, 3), c_inverse(3, 3), c_rate(3, 3), g, slopes(3, 3), scalars(8), s(3, 3), tau(3, 3), idle, from(3, 3), in_plane
   logical :: locked, fault
   integer :: i
   call flow_stage(dfgrd0, dfgrd1, props, statev, locked, from)
   in_plane = merge(0.0_dp, 1.0_dp, maxval(abs(from - dfgrd0)) > 0)
   call law_stress(from, dfgrd1, dtime, props, locked, in_plane, c, c_inverse, c_rate, g, slopes, scalars, s, fault)
   if (fault) then
      pnewdt = min(pnewdt, 0.25_dp)
      return
   end if
   tau = matmul(matmul(dfgrd1, s), transpose(dfgrd1))
   do i = 1, 6
      stress(i) = tau(row(i), column(i))/scalars(1)
   end do
   if (way == 'perturbed') then
      call perturbed_tangent(from, dfgrd1, dtime, props, locked, in_plane, tau, scalars(1), ddsdde)
   else
      idle = idle_factor(scalars, props(p_a), locked, statev(s_eps_rate))
      call four_index_tangent(dfgrd1, c, c_inverse, c_rate, g*idle, slopes, dtime, props, scalars(5), tau, scalars(1), ddsdde)
   end if
   call finish(scalars, g, dtime, locked, statev, scd)
end subroutine umat
