!! Small pieces of text handling for the case reader: lines, keys, words, numbers.
module driver_text
   use driver_kinds, only: dp
   implicit none
   private
   public :: read_line, split_assignment, lower_case, to_number, to_numbers, to_logical
   integer, parameter :: longest_line = 4096

   type :: word
      character(len=:), allocatable :: text
   end type word
contains
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

   !! Words between blanks and commas.
   pure subroutine split_words(text, list)
      character(len=*), intent(in) :: text
      type(word), allocatable, intent(out) :: list(:)
      integer :: first, last
      allocate (list(0))
      first = 1
      do
         last = verify(text(first:), ' ,')
         if (last == 0) exit
         first = first + last - 1
         last = scan(text(first:), ' ,')
         if (last == 0) last = len(text) - first + 2
         list = [list, word(text(first:first + last - 2))]
         first = first + last - 1
         if (first > len(text)) exit
      end do
   end subroutine split_words

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

   pure subroutine to_numbers(text, values, valid)
      character(len=*), intent(in) :: text
      real(dp), allocatable, intent(out) :: values(:)
      logical, intent(out) :: valid
      type(word), allocatable :: list(:)
      logical :: this_valid
      integer :: i
      call split_words(text, list)
      allocate (values(size(list)))
      valid = size(list) > 0
      do i = 1, size(list)
         call to_number(list(i)%text, values(i), this_valid)
         valid = valid .and. this_valid
      end do
   end subroutine to_numbers

   pure subroutine to_logical(text, value, valid)
      character(len=*), intent(in) :: text
      logical, intent(out) :: value, valid
      value = lower_case(text) == 'yes'
      valid = value .or. lower_case(text) == 'no'
   end subroutine to_logical
end module driver_text
