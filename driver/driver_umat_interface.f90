!! The call of a UMAT and of the message accessor by their addresses.
module driver_umat_interface
   use, intrinsic :: iso_c_binding, only: c_char, c_double, c_f_procpointer, c_int, &
      c_null_char, c_null_funptr, c_size_t
   use driver_kinds, only: address_kind, text_length
   implicit none
   private
   public :: umat_procedure, standin_procedure, umat_at, standin_at, take_messages

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

   !! What the UMAT said through STDB_ABQERR since the last call, and whether it called XIT.
   subroutine take_messages(standin, stop_asked, text)
      procedure(standin_procedure), pointer, intent(in) :: standin
      logical, intent(out) :: stop_asked
      character(len=:), allocatable, intent(out) :: text
      character(kind=c_char) :: buffer(text_length)
      integer(c_int) :: flag, messages
      integer :: i
      stop_asked = .false.
      text = ''
      flag = 0
      buffer = c_null_char
      if (.not. associated(standin)) return
      messages = standin(flag, buffer, int(text_length, c_int))
      stop_asked = flag /= 0
      if (messages <= 0) return
      do i = 1, text_length
         if (buffer(i) == c_null_char) exit
         text = text//buffer(i)
      end do
   end subroutine take_messages
end module driver_umat_interface
