!! The keys of a case file: outside blocks, in a step, and at the start.
module driver_case_keys
   use driver_kinds, only: dp, kind_deformation, kind_held, kind_stress
   use driver_case, only: load_step, material_point_case
   use driver_text, only: to_number, to_numbers, to_logical
   implicit none
   private
   public :: case_file, start_values, read_general, read_start, read_step
   character(len=2), parameter, public :: component_name(9) = ['11', '22', '33', '12', '13', '23', '21', '31', '32']

   type :: case_file
      type(material_point_case) :: problem
      character(len=:), allocatable :: library, symbol      !! shared library and entry point of the UMAT
      character(len=:), allocatable :: history, increments, replay   !! names of the files to write
      character(len=:), allocatable :: message              !! what is wrong with the case; empty: nothing
   end type case_file

   type :: start_values
      real(dp), allocatable :: f(:), stress(:), strain(:), statev(:), energies(:), guess(:)
      real(dp) :: step_time = 0.0_dp, total_time = 0.0_dp, pressure = 0.0_dp
      integer :: step = 1, increment = 0
   end type start_values
contains
   pure subroutine read_general(key, value, case)
      character(len=*), intent(in) :: key, value
      type(case_file), intent(inout) :: case
      real(dp), allocatable :: numbers(:)
      logical :: valid
      associate (material => case%problem%material)
         valid = .true.
         select case (key)
         case ('library'); case%library = value
         case ('symbol'); case%symbol = value
         case ('material'); material%name = value
         case ('history'); case%history = value
         case ('increments'); case%increments = value
         case ('replay'); case%replay = value
         case ('corotated'); call to_logical(value, material%corotated, valid)
         case ('temperature'); call to_number(value, material%temperature, valid)
         case ('n_statev'); call to_count(value, material%n_statev, valid)
         case ('ntens'); call to_count(value, material%ntens, valid)
         case ('props')
            call to_numbers(value, numbers, valid)
            if (valid) material%props = [material%props, numbers]
         case default
            case%message = "unknown key '"//key//"' outside a block: use library, symbol, material, n_statev, "// &
                           'ntens, temperature, props, corotated, history, increments or replay'
            return
         end select
      end associate
      if (.not. valid) case%message = "'"//value//"' is no valid value of '"//key//"'"
   end subroutine read_general

   !! "F11", "S22", "P33": what is prescribed of which component.
   pure subroutine read_step(key, value, step, message)
      character(len=*), intent(in) :: key, value
      type(load_step), intent(inout) :: step
      character(len=:), allocatable, intent(inout) :: message
      real(dp) :: number
      logical :: valid
      integer :: i
      if (key == 'instant') then
         call to_logical(value, step%instant, valid)
      else
         call to_number(value, number, valid)
      end if
      if (.not. valid) then
         message = "'"//value//"' is no valid value of '"//key//"'"
      else if (key == 'duration') then
         step%duration = number
      else if (key /= 'instant') then
         i = 0
         if (len(key) == 3 .and. scan(key(1:1), 'fsp') == 1) i = findloc(component_name, key(2:), dim=1)
         if (i == 0 .or. (i > 3 .and. key(1:1) == 'p') .or. (i > 6 .and. key(1:1) /= 'f')) then
            message = "unknown key '"//key//"' in a step: use duration, instant, F11 to F32, S11 to S23, P11, P22, P33"
         else if (step%kind(i) /= kind_held) then
            message = 'component '//component_name(i)//' is prescribed twice: keep one'
         else
            step%kind(i) = merge(kind_deformation, kind_stress, key(1:1) == 'f')
            step%target(i) = merge(-number, number, key(1:1) == 'p')
         end if
      end if
   end subroutine read_step

   pure subroutine read_start(key, value, start, message)
      character(len=*), intent(in) :: key, value
      type(start_values), intent(inout) :: start
      character(len=:), allocatable, intent(inout) :: message
      real(dp), allocatable :: numbers(:)
      logical :: valid
      call to_numbers(value, numbers, valid)
      if (.not. valid) then
         message = "'"//value//"' is no valid value of '"//key//"'"
         return
      end if
      select case (key)
      case ('deformation_gradient'); start%f = numbers
      case ('first_guess'); start%guess = numbers
      case ('stress'); start%stress = numbers
      case ('strain'); start%strain = numbers
      case ('energies'); start%energies = numbers
      case ('statev')
         if (.not. allocated(start%statev)) allocate (start%statev(0))
         start%statev = [start%statev, numbers]
      case ('pressure'); start%pressure = numbers(1)
      case ('step_time'); start%step_time = numbers(1)
      case ('total_time'); start%total_time = numbers(1)
      case ('step'); start%step = nint(numbers(1))
      case ('increment'); start%increment = nint(numbers(1))
      case default
         message = "unknown key '"//key//"' in the start: use deformation_gradient, first_guess, stress, strain, "// &
                   'statev, energies, pressure, step_time, total_time, step or increment'
      end select
   end subroutine read_start

   pure subroutine to_count(text, value, valid)
      character(len=*), intent(in) :: text
      integer, intent(out) :: value
      logical, intent(out) :: valid
      real(dp) :: number
      call to_number(text, number, valid)
      valid = valid .and. number >= 0.0_dp .and. number <= 1.0e6_dp
      value = 0
      if (valid) value = nint(number)
   end subroutine to_count
end module driver_case_keys
