!! Shared libraries by the C library's dlopen and dlsym.
module driver_dynamic_library
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_int, c_null_char, c_ptr, c_f_pointer
   use driver_kinds, only: address_kind
   implicit none
   private
   public :: open_library, symbol_address
   integer(c_int), parameter :: bind_now = 2_c_int          !! RTLD_NOW of Linux and the BSDs

   interface
      function c_dlopen(path, mode) bind(c, name='dlopen') result(handle)
         import :: c_char, c_int, c_ptr
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value :: mode
         type(c_ptr) :: handle
      end function c_dlopen
      function c_dlsym(handle, symbol) bind(c, name='dlsym') result(address)
         import :: c_char, c_ptr
         type(c_ptr), value :: handle
         character(kind=c_char), intent(in) :: symbol(*)
         type(c_ptr) :: address
      end function c_dlsym
      function c_dlerror() bind(c, name='dlerror') result(text)
         import :: c_ptr
         type(c_ptr) :: text
      end function c_dlerror
   end interface
contains
   subroutine open_library(path, handle, message)
      character(len=*), intent(in) :: path                  !! a name without slash is looked for by the loader
      type(c_ptr), intent(out) :: handle
      character(len=:), allocatable, intent(out) :: message !! empty: loaded
      handle = c_dlopen(path//c_null_char, bind_now)
      message = ''
      if (.not. c_associated(handle)) message = last_error()
   end subroutine open_library

   !! Address of a symbol, 0 if the library has none of that name.
   function symbol_address(handle, symbol) result(address)
      type(c_ptr), intent(in) :: handle
      character(len=*), intent(in) :: symbol
      integer(address_kind) :: address
      address = transfer(c_dlsym(handle, symbol//c_null_char), address)
   end function symbol_address

   function last_error() result(text)
      character(len=:), allocatable :: text
      character(kind=c_char), pointer :: characters(:)
      type(c_ptr) :: raw
      integer :: i
      text = ''
      raw = c_dlerror()
      if (.not. c_associated(raw)) return
      call c_f_pointer(raw, characters, [1024])
      do i = 1, size(characters)
         if (characters(i) == c_null_char) exit
         text = text//characters(i)
      end do
   end function last_error
end module driver_dynamic_library
