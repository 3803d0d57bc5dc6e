!! Stand-ins for the two utility routines of Abaqus that the emitted UMAT calls: STDB_ABQERR and XIT.
!! They keep the messages of the calling thread until the host takes them, instead of printing or stopping.
module plyflow_abaqus_standins
  use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
  implicit none
  private
  public :: keep_message, request_stop, plyflow_standin_take

  integer, parameter :: capacity = 4096
  character(len=capacity) :: messages = ''
  integer :: used = 0, count = 0, stopped = 0
  !$omp threadprivate(messages, used, count, stopped)

contains

  !! Append one message.
  subroutine keep_message(text)
    character(len=*), intent(in) :: text !! message without trailing blanks
    count = count + 1
    if (used + len(text) + 1 > capacity) return
    if (used > 0) then
      used = used + 1
      messages(used:used) = new_line('a')
    end if
    messages(used + 1:used + len(text)) = text
    used = used + len(text)
  end subroutine keep_message

  !! Remember that the analysis is to end.
  subroutine request_stop()
    stopped = 1
  end subroutine request_stop

  !! Number of messages since the last call; the texts, joined by newlines and NUL terminated; whether to stop.
  function plyflow_standin_take(stop_flag, text, text_length) result(number) bind(c)
    integer(c_int), intent(out) :: stop_flag !! 1 when XIT was called or an error of level -3 was reported
    integer(c_int), intent(in), value :: text_length !! room in `text`, at least 1
    character(kind=c_char), intent(out) :: text(text_length) !! messages
    integer(c_int) :: number
    integer :: i, n
    number = int(count, c_int)
    stop_flag = int(stopped, c_int)
    n = min(used, int(text_length) - 1)
    do i = 1, n
      text(i) = messages(i:i)
    end do
    text(n + 1) = c_null_char
    used = 0
    count = 0
    stopped = 0
  end function plyflow_standin_take

end module plyflow_abaqus_standins

!! Abaqus's message routine: %I, %R and %S in the text take the next integer, real and character value.
!! Levels: 1 information, -1 warning, -2 error (the analysis goes on), -3 error (the analysis ends).
subroutine stdb_abqerr(lop, string, intv, realv, charv)
  use plyflow_abaqus_standins, only: keep_message, request_stop
  implicit none
  integer, intent(in) :: lop
  character(len=*), intent(in) :: string
  integer, intent(in) :: intv(*)
  double precision, intent(in) :: realv(*)
  character(len=8), intent(in) :: charv(*)
  character(len=1000) :: text
  character(len=32) :: field
  integer :: i, length, place(3)

  text = ''
  length = 0
  place = 0
  i = 1
  do while (i <= len_trim(string))
    field = string(i:i)
    if (string(i:i) == '%' .and. i < len(string)) then
      select case (string(i + 1:i + 1))
      case ('I', 'i')
        place(1) = place(1) + 1
        write (field, '(i0)') intv(place(1))
        i = i + 1
      case ('R', 'r')
        place(2) = place(2) + 1
        write (field, '(es13.6)') realv(place(2))
        if (index(field, 'E') == 0) write (field, '(es14.6e3)') realv(place(2))
        field = adjustl(field)
        i = i + 1
      case ('S', 's')
        place(3) = place(3) + 1
        field = charv(place(3))
        i = i + 1
      end select
    end if
    associate (width => max(len_trim(field), 1))
      if (length + width > len(text)) exit
      text(length + 1:length + width) = field(1:width)
      length = length + width
    end associate
    i = i + 1
  end do
  call keep_message(text(1:length))
  if (lop == -3) call request_stop()
end subroutine stdb_abqerr

!! Abaqus's orderly end of the analysis.
subroutine xit()
  use plyflow_abaqus_standins, only: request_stop
  implicit none
  call request_stop()
end subroutine xit
