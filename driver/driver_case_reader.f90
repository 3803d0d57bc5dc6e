!! Case files: "key = value" lines, blocks between "begin NAME" and "end NAME", comments after "!".
module driver_case_reader
   use, intrinsic :: iso_c_binding, only: c_ptr
   use driver_kinds, only: dp
   use driver_case, only: load_step, validate_case
   use driver_case_keys, only: case_file, read_general, read_start, read_step, set_control, take_vector
   use driver_dynamic_library, only: open_library, symbol_address
   use driver_text, only: read_line, split_assignment, lower_case
   implicit none
   private
   public :: read_case
contains
   subroutine read_case(path, case)
      character(len=*), intent(in) :: path
      type(case_file), intent(out) :: case
      type(load_step) :: step
      character(len=:), allocatable :: line, block
      character(len=12) :: number
      logical :: ended
      integer :: unit, status, count
      call set_defaults(path, case)
      open (newunit=unit, file=path, status='old', action='read', iostat=status)
      if (status /= 0) then
         case%message = path//': cannot be opened'
         return
      end if
      block = ''
      count = 0
      do
         call read_line(unit, line, ended)
         if (ended) exit
         count = count + 1
         if (len(line) == 0) cycle
         call read_statement(line, case, step, block)
         if (len(case%message) > 0) exit
      end do
      close (unit)
      write (number, '(i0)') count
      if (len(case%message) > 0) then
         case%message = path//':'//trim(number)//': '//case%message
      else if (len(block) > 0) then
         case%message = path//":"//trim(number)//": block '"//block//"' is not ended: write 'end "//block//"'"
      else
         call finish_case(path, case)
      end if
   end subroutine read_case

   subroutine set_defaults(path, case)
      character(len=*), intent(in) :: path
      type(case_file), intent(inout) :: case
      character(len=:), allocatable :: stem
      integer :: dot
      dot = index(path, '.', back=.true.)
      stem = path
      if (dot > index(path, '/', back=.true.) + 1) stem = path(:dot - 1)
      case%message = ''
      case%library = ''
      case%symbol = 'umat_'
      case%history = stem//'.csv'
      case%increments = stem//'.sta'
      case%replay = stem//'.replay.txt'
      allocate (case%problem%material%props(0), case%problem%steps(0), case%statev(0))
   end subroutine set_defaults

   !! One line that is not blank: the begin or end of a block, or an assignment.
   subroutine read_statement(line, case, step, block)
      character(len=*), intent(in) :: line
      type(case_file), intent(inout) :: case
      type(load_step), intent(inout) :: step
      character(len=:), allocatable, intent(inout) :: block
      character(len=:), allocatable :: key, value
      logical :: found
      if (index(lower_case(line), 'begin ') == 1) then
         call begin_block(lower_case(trim(adjustl(line(7:)))), block, step, case%message)
      else if (index(lower_case(line), 'end ') == 1) then
         call end_block(lower_case(trim(adjustl(line(5:)))), block, step, case)
      else
         call split_assignment(line, key, value, found)
         if (.not. found .or. len(value) == 0) then
            case%message = "'"//line//"' is neither 'key = value' nor 'begin NAME' nor 'end NAME'"
            return
         end if
         select case (block)
         case (''); call read_general(key, value, case)
         case ('controls'); call set_control(case%problem%controls, key, value, case%message)
         case ('start'); call read_start(key, value, case)
         case ('step'); call read_step(key, value, step, case%message)
         end select
      end if
   end subroutine read_statement

   pure subroutine begin_block(name, block, step, message)
      character(len=*), intent(in) :: name
      character(len=:), allocatable, intent(inout) :: block, message
      type(load_step), intent(inout) :: step
      if (len(block) > 0) then
         message = "block '"//name//"' begins inside block '"//block//"': end that one first"
      else if (name /= 'step' .and. name /= 'controls' .and. name /= 'start') then
         message = "unknown block '"//name//"': use step, controls or start"
      else
         block = name
         step = load_step(duration=0.0_dp)
      end if
   end subroutine begin_block

   pure subroutine end_block(name, block, step, case)
      character(len=*), intent(in) :: name
      character(len=:), allocatable, intent(inout) :: block
      type(load_step), intent(in) :: step
      type(case_file), intent(inout) :: case
      if (name /= block) then
         case%message = "'end "//name//"' does not end block '"//block//"'"
         return
      end if
      if (block == 'step') then
         if (step%duration > 0.0_dp) then
            case%problem%steps = [case%problem%steps, step]
         else
            case%message = 'the step has no positive duration: write duration = SECONDS'
         end if
      end if
      block = ''
   end subroutine end_block

   subroutine finish_case(path, case)
      character(len=*), intent(in) :: path
      type(case_file), intent(inout) :: case
      associate (problem => case%problem)
         allocate (problem%start%statev(problem%material%n_statev), source=0.0_dp)
         if (size(case%statev) > 0) call take_vector('statev', case%statev, problem%start%statev, case%message)
         if (len(case%message) == 0 .and. size(problem%steps) > 0) case%message = validate_case(problem)
         if (size(problem%steps) == 0) case%message = "no step: write 'begin step', its lines, 'end step'"
      end associate
      if (len(case%message) == 0) call load_umat(case)
      if (len(case%message) > 0) case%message = path//': '//case%message
   end subroutine finish_case

   subroutine load_umat(case)
      type(case_file), intent(inout) :: case
      type(c_ptr) :: handle
      if (len(case%library) == 0) then
         case%message = 'no UMAT: write library = PATH of a shared library'
         return
      end if
      call open_library(case%library, handle, case%message)
      if (len(case%message) > 0) return
      case%problem%material%umat_address = symbol_address(handle, case%symbol)
      case%problem%material%standin_address = symbol_address(handle, 'plyflow_standin_take')
      if (case%problem%material%umat_address == 0) &
         case%message = case%library//" has no symbol '"//case%symbol//"': write symbol = NAME of the UMAT"
   end subroutine load_umat
end module driver_case_reader
