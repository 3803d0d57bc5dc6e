!! Case files: "key = value" lines, blocks between "begin NAME" and "end NAME", comments after "!".
module driver_case_reader
   use, intrinsic :: iso_c_binding, only: c_ptr
   use driver_kinds, only: dp
   use driver_case, only: load_step, new_state, validate_case
   use driver_case_keys, only: case_file, start_values, read_general, read_start, read_step, set_control
   use driver_dynamic_library, only: open_library, symbol_address
   use driver_text, only: read_line, split_assignment, lower_case
   implicit none
   private
   public :: read_case
contains
   subroutine read_case(path, case)
      character(len=*), intent(in) :: path
      type(case_file), intent(out) :: case
      type(start_values) :: start
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
         call read_statement(line, case, start, step, block)
         if (len(case%message) > 0) exit
      end do
      close (unit)
      write (number, '(i0)') count
      if (len(case%message) > 0) then
         case%message = path//':'//trim(number)//': '//case%message
      else if (len(block) > 0) then
         case%message = path//":"//trim(number)//": block '"//block//"' is not ended: write 'end "//block//"'"
      else
         call finish_case(path, case, start)
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
      allocate (case%problem%material%props(0), case%problem%steps(0))
   end subroutine set_defaults

   !! One line that is not blank: the begin or end of a block, or an assignment.
   subroutine read_statement(line, case, start, step, block)
      character(len=*), intent(in) :: line
      type(case_file), intent(inout) :: case
      type(start_values), intent(inout) :: start
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
         case ('start'); call read_start(key, value, start, case%message)
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

   subroutine finish_case(path, case, start)
      character(len=*), intent(in) :: path
      type(case_file), intent(inout) :: case
      type(start_values), intent(in) :: start
      associate (state => case%problem%start, problem => case%problem)
         state = new_state(problem%material%n_statev)
         state%step_time = start%step_time
         state%total_time = start%total_time
         state%pressure = start%pressure
         state%step = start%step
         state%increment = start%increment
         call take_matrix('deformation_gradient', start%f, state%f, case%message)
         call take_vector('stress', start%stress, state%stress, case%message)
         call take_vector('strain', start%strain, state%stran, case%message)
         call take_vector('energies', start%energies, state%energy, case%message)
         call take_vector('statev', start%statev, state%statev, case%message)
         if (allocated(start%guess)) then
            allocate (problem%first_guess(3, 3))
            call take_matrix('first_guess', start%guess, problem%first_guess, case%message)
         end if
         if (len(case%message) == 0 .and. size(problem%steps) > 0) case%message = validate_case(problem)
         if (size(problem%steps) == 0) case%message = "no step: write 'begin step', its lines, 'end step'"
      end associate
      if (len(case%message) == 0) call load_umat(case)
      if (len(case%message) > 0) case%message = path//': '//case%message
   end subroutine finish_case

   pure subroutine take_vector(name, given, taken, message)
      character(len=*), intent(in) :: name
      real(dp), allocatable, intent(in) :: given(:)
      real(dp), intent(inout) :: taken(:)
      character(len=:), allocatable, intent(inout) :: message
      character(len=80) :: counts
      if (.not. allocated(given)) return
      if (size(given) == size(taken)) then
         taken = given
      else if (len(message) == 0) then
         write (counts, '(a,i0,a,i0)') ' has ', size(given), ' values; it needs ', size(taken)
         message = name//trim(counts)
      end if
   end subroutine take_vector

   pure subroutine take_matrix(name, given, taken, message)
      character(len=*), intent(in) :: name
      real(dp), allocatable, intent(in) :: given(:)         !! row by row
      real(dp), intent(inout) :: taken(3, 3)
      character(len=:), allocatable, intent(inout) :: message
      real(dp) :: flat(9)
      flat = reshape(transpose(taken), [9])
      call take_vector(name, given, flat, message)
      taken = transpose(reshape(flat, [3, 3]))
   end subroutine take_matrix

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
