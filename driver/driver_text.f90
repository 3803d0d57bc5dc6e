!! Small pieces of text handling for the case reader: lines, keys, words, numbers.
module driver_text
   use driver_kinds, only: dp
   implicit none
   private
   public :: open_new, read_line, split_assignment, lower_case, to_number, to_numbers, to_logical
   integer, parameter :: longest_line = 4096
contains
   !! A file for writing; `message` says if it cannot be.
   subroutine open_new(path, unit, message)
      character(len=*), intent(in) :: path
      integer, intent(out) :: unit
      character(len=:), allocatable, intent(inout) :: message
      integer :: status
      open (newunit=unit, file=path, status='replace', action='write', iostat=status)
      if (status /= 0) message = path//': cannot be written'
   end subroutine open_new

   !! The next line without its comment and surrounding blanks; `ended` at the end of the file.
   subroutine read_line(unit, line, ended)
      integer, intent(in) :: unit
      character(len=:), allocatable, intent(out) :: line
      logical, intent(out) :: ended
      character(len=longest_line) :: buffer
      integer :: status, comment
      read (unit, '(a)', iostat=status) buffer
      ended = status /= 0
      line = ''
      if (ended) return
      comment = index(buffer, '!')
      if (comment > 0) buffer(comment:) = ' '
      do comment = 1, longest_line                          ! tabs count as blanks
         if (buffer(comment:comment) == achar(9)) buffer(comment:comment) = ' '
      end do
      line = trim(adjustl(buffer))
   end subroutine read_line

   !! "key = value" into its two sides; `found` is false without an equals sign or without a key.
   pure subroutine split_assignment(line, key, value, found)
      character(len=*), intent(in) :: line
      character(len=:), allocatable, intent(out) :: key, value
      logical, intent(out) :: found
      integer :: equals
      equals = index(line, '=')
      found = equals > 1
      key = ''
      value = ''
      if (.not. found) return
      key = lower_case(trim(adjustl(line(:equals - 1))))
      value = trim(adjustl(line(equals + 1:)))
   end subroutine split_assignment

   pure function lower_case(text) result(lower)
      character(len=*), intent(in) :: text
      character(len=len(text)) :: lower
      integer :: i
      lower = text
      do i = 1, len(text)
         if (text(i:i) >= 'A' .and. text(i:i) <= 'Z') lower(i:i) = achar(iachar(text(i:i)) + 32)
      end do
   end function lower_case

   pure subroutine to_number(text, value, valid)
      character(len=*), intent(in) :: text
      real(dp), intent(out) :: value
      logical, intent(out) :: valid
      integer :: status
      value = 0.0_dp
      valid = len(text) > 0 .and. verify(text, '0123456789+-.eEdD') == 0
      if (.not. valid) return
      read (text, *, iostat=status) value
      valid = status == 0 .and. abs(value) <= huge(value)
   end subroutine to_number

   !! Numbers between blanks and commas.
   pure subroutine to_numbers(text, values, valid)
      character(len=*), intent(in) :: text
      real(dp), allocatable, intent(out) :: values(:)
      logical, intent(out) :: valid
      real(dp) :: value
      logical :: this_valid
      integer :: first, length
      allocate (values(0))
      valid = .true.
      first = 1
      do while (first <= len(text))
         length = scan(text(first:)//' ', ' ,') - 1
         if (length > 0) then
            call to_number(text(first:first + length - 1), value, this_valid)
            valid = valid .and. this_valid
            values = [values, value]
         end if
         first = first + length + 1
      end do
      valid = valid .and. size(values) > 0
   end subroutine to_numbers

   pure subroutine to_logical(text, value, valid)
      character(len=*), intent(in) :: text
      logical, intent(out) :: value, valid
      value = lower_case(text) == 'yes'
      valid = value .or. lower_case(text) == 'no'
   end subroutine to_logical
end module driver_text
