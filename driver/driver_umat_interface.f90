!! The call of a UMAT and of the message accessor by their addresses.
module driver_umat_interface
   use, intrinsic :: iso_c_binding, only: c_char, c_double, c_f_procpointer, c_int, &
      c_null_char, c_null_funptr, c_size_t
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan
   use driver_kinds, only: dp, address_kind, text_length, pnewdt_untouched, outcome_converged, outcome_not_finite, &
      outcome_pnewdt, outcome_stopped
   implicit none
   private
   public :: umat_procedure, standin_procedure, umat_at, standin_at, call_umat, take_messages, outcome_of_call

   abstract interface
      !! Abaqus's 37 arguments in its order. The length of CMNAME, which a Fortran compiler passes hidden
      !! and last, is spelled out so that the call does not depend on the compiler of the UMAT.
      subroutine umat_procedure(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, &
                                time, dtime, temp, dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, &
                                nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, noel, npt, layer, kspt, &
                                jstep, kinc, cmname_length) bind(c)
         import :: c_char, c_double, c_int, c_size_t
         real(c_double), intent(inout) :: stress(*), statev(*), ddsdde(*), sse, spd, scd, rpl, ddsddt(*), drplde(*)
         real(c_double), intent(inout) :: drpldt, pnewdt
         real(c_double), intent(in) :: stran(*), dstran(*), time(2), dtime, temp, dtemp, predef(*), dpred(*)
         real(c_double), intent(in) :: props(*), coords(3), drot(3, 3), celent, dfgrd0(3, 3), dfgrd1(3, 3)
         character(kind=c_char), intent(in) :: cmname(*)
         integer(c_int), intent(in) :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, jstep(4), kinc
         integer(c_size_t), value :: cmname_length
      end subroutine umat_procedure

      !! int plyflow_standin_take(int *stop, char *text, int text_length)
      function standin_procedure(stop_asked, text, length) result(messages) bind(c)
         import :: c_char, c_int
         integer(c_int), intent(inout) :: stop_asked
         character(kind=c_char), intent(inout) :: text(*)
         integer(c_int), value :: length
         integer(c_int) :: messages
      end function standin_procedure
   end interface
contains
   subroutine umat_at(address, umat)
      integer(address_kind), intent(in) :: address         !! address of the UMAT's entry point
      procedure(umat_procedure), pointer, intent(out) :: umat
      call c_f_procpointer(transfer(address, c_null_funptr), umat)
   end subroutine umat_at

   subroutine standin_at(address, standin)
      integer(address_kind), intent(in) :: address         !! address of plyflow_standin_take; 0: there is none
      procedure(standin_procedure), pointer, intent(out) :: standin
      nullify (standin)
      if (address /= 0) call c_f_procpointer(transfer(address, c_null_funptr), standin)
   end subroutine standin_at

   !! One call with everything that this driver never changes: no heat, no coupling, one element of unit length.
   subroutine call_umat(umat, name, number, jstep, kinc, ntens, n_statev, props, temperature, heating, time, dtime, &
                        stran, dstran, drot, f_start, f_end, stress, statev, energy, ddsdde, pnewdt)
      procedure(umat_procedure), pointer, intent(in) :: umat
      character(len=*), intent(in) :: name                 !! CMNAME, 80 characters
      integer, intent(in) :: number, jstep, kinc           !! NOEL, step, increment
      integer, intent(in) :: ntens, n_statev
      real(dp), contiguous, intent(in) :: props(:)
      real(dp), intent(in) :: temperature, heating         !! TEMP, DTEMP, degC
      real(dp), intent(in) :: time(2), dtime, stran(6), dstran(6), drot(3, 3), f_start(3, 3), f_end(3, 3)
      real(dp), intent(inout) :: stress(ntens), statev(n_statev), energy(3), ddsdde(ntens, ntens)
      real(dp), intent(out) :: pnewdt
      real(dp) :: rpl, ddsddt(6), drplde(6), drpldt
      real(dp), parameter :: zero(3) = 0.0_dp
      rpl = 0.0_dp; ddsddt = 0.0_dp; drplde = 0.0_dp; drpldt = 0.0_dp
      ddsdde = 0.0_dp
      pnewdt = pnewdt_untouched
      call umat(stress, statev, ddsdde, energy(1), energy(2), energy(3), rpl, ddsddt, drplde, drpldt, stran, dstran, &
                time, dtime, temperature, heating, zero, zero, transfer(name, [c_null_char], len(name)), 3_c_int, &
                int(ntens - 3, c_int), int(ntens, c_int), int(n_statev, c_int), props, size(props, kind=c_int), zero, &
                drot, pnewdt, 1.0_dp, f_start, f_end, int(number, c_int), 1_c_int, 1_c_int, 1_c_int, &
                [int(jstep, c_int), 1_c_int, 1_c_int, 0_c_int], int(kinc, c_int), len(name, kind=c_size_t))
   end subroutine call_umat

   !! What the UMAT said through STDB_ABQERR since the last call (else `text` stays), and whether it called XIT.
   subroutine take_messages(standin, stop_asked, text)
      procedure(standin_procedure), pointer, intent(in) :: standin
      logical, intent(out) :: stop_asked
      character(len=:), allocatable, intent(inout) :: text
      character(kind=c_char) :: buffer(text_length)
      integer(c_int) :: flag
      integer :: length
      flag = 0
      if (associated(standin)) then
         if (standin(flag, buffer, int(text_length, c_int)) > 0) then
            length = findloc(buffer, c_null_char, dim=1) - 1
            if (length < 0) length = text_length
            text = transfer(buffer(:length), repeat(' ', length))
         end if
      end if
      stop_asked = flag /= 0
   end subroutine take_messages

   !! Order of the verdicts: a stop ends all, a smaller PNEWDT explains whatever else came with it, then NaN.
   pure integer function outcome_of_call(stop_asked, pnewdt, stress, statev, energy, ddsdde) result(outcome)
      logical, intent(in) :: stop_asked
      real(dp), intent(in) :: pnewdt, stress(:), statev(:), energy(:), ddsdde(:, :)
      outcome = outcome_converged
      if (stop_asked) then
         outcome = outcome_stopped
      else if (pnewdt < 1.0_dp) then
         outcome = outcome_pnewdt
      else if (.not. (all(ieee_is_finite(stress)) .and. all(ieee_is_finite(statev)) .and. all(ieee_is_finite(energy)) &
                      .and. all(ieee_is_finite(ddsdde))) .or. ieee_is_nan(pnewdt)) then
         outcome = outcome_not_finite
      end if
   end function outcome_of_call
end module driver_umat_interface
