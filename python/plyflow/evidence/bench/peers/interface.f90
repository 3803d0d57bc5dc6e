!! Peer UMAT @NAME@: the law of law.f90, DDSDDE by @TANGENT@.
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, &
                dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, &
                dfgrd0, dfgrd1, noel, npt, layer, kspt, kstep, kinc)
   implicit none
   integer, parameter :: dp = kind(1.0d0)
   character(len=80) :: cmname
   integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, kstep, kinc
   real(dp) :: stress(ntens), statev(nstatv), ddsdde(ntens, ntens), sse, spd, scd, rpl, ddsddt(ntens), drplde(ntens)
   real(dp) :: drpldt, stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(1), dpred(1), props(nprops)
   real(dp) :: coords(3), drot(3, 3), pnewdt, celent, dfgrd0(3, 3), dfgrd1(3, 3)
   real(dp) :: c(3, 3), c_inverse(3, 3), c_rate(3, 3), g, slopes(3, 3), scalars(8), s(3, 3), tau(3, 3), idle
   real(dp) :: x_start, lock_stretch
   logical :: locked, fault
   integer, parameter :: row(6) = [1, 2, 3, 1, 1, 2], column(6) = [1, 2, 3, 2, 3, 3]
   integer :: i
   associate (u1 => stran, u2 => dstran, u3 => temp, u4 => dtemp, u5 => predef, u6 => dpred, u7 => coords, u8 => drot)
   end associate
   associate (u1 => celent, u2 => layer, u3 => kspt, u4 => spd, u5 => rpl, u6 => ddsddt, u7 => drplde, u8 => drpldt)
   end associate
   associate (u1 => cmname, u2 => noel, u3 => npt, u4 => kstep, u5 => kinc, u6 => sse, u7 => time, u8 => ndi, u9 => nshr)
   end associate
   call flow_stage(dfgrd0, props, statev, locked, x_start, lock_stretch)
   call law_stress(dfgrd0, dfgrd1, dtime, props, locked, c, c_inverse, c_rate, g, slopes, scalars, s, fault)
   if (fault) then
      pnewdt = min(pnewdt, 0.25_dp)
      return
   end if
   call idle_factor(scalars, props(5), locked, statev(7), idle)
   call push_forward(dfgrd1, s, tau)
   do i = 1, 6
      stress(i) = tau(row(i), column(i))/scalars(1)
   end do
   @CALL@
   call finish(scalars, g, dtime, props, locked, x_start, lock_stretch, statev, scd, pnewdt)
end subroutine umat
