!! STDB_ABQERR and XIT for materials that run inside CalculiX: messages go to standard output, XIT ends the analysis.

!! Abaqus's message routine: %I, %R and %S in the text take the next integer, real and character value.
!! Levels: 1 information, -1 warning, -2 error (the analysis goes on), -3 error (the analysis ends).
subroutine stdb_abqerr(lop, string, intv, realv, charv)
  use, intrinsic :: iso_fortran_env, only: output_unit
  implicit none
  integer, intent(in) :: lop
  character(len=*), intent(in) :: string
  integer, intent(in) :: intv(*)
  double precision, intent(in) :: realv(*)
  character(len=8), intent(in) :: charv(*)
  character(len=:), allocatable :: text
  character(len=32) :: field
  integer :: i, place(3)

  text = merge('*INFO', '*WARN', lop > 0)
  if (lop < -1) text = '*ERROR'
  text = text//' '
  place = 0
  i = 1
  do while (i <= len_trim(string))
    if (string(i:i) /= '%' .or. i == len(string)) then
      text = text//string(i:i)
      i = i + 1
      cycle
    end if
    select case (string(i + 1:i + 1))
    case ('I', 'i')
      place(1) = place(1) + 1
      write (field, '(i0)') intv(place(1))
    case ('R', 'r')
      place(2) = place(2) + 1
      write (field, '(es13.6)') realv(place(2))
    case ('S', 's')
      place(3) = place(3) + 1
      field = charv(place(3))
    case default
      field = string(i:i + 1)
    end select
    text = text//trim(adjustl(field))
    i = i + 2
  end do
  write (output_unit, '(1x,a)') text
end subroutine stdb_abqerr

!! End of the analysis, with the status CalculiX's own materials use.
subroutine xit()
  use, intrinsic :: iso_c_binding, only: c_int
  implicit none
  interface
    subroutine c_exit(status) bind(c, name='exit')
      import :: c_int
      integer(c_int), value :: status
    end subroutine c_exit
  end interface
  call c_exit(201_c_int)
end subroutine xit
