!! The keys of a case file: outside blocks, in a step, at the start, and the names of the controls.
module driver_case_keys
   use driver_kinds, only: dp, kind_deformation, kind_held, kind_stress
   use driver_case, only: load_step, control_settings, material_point_case
   use driver_text, only: to_number, to_numbers, to_logical
   implicit none
   private
   public :: case_file, read_general, read_start, read_step, set_control, &
      write_controls, take_vector
   character(len=2), parameter, public :: component_name(9) = ['11', '22', '33', '12', '13', '23', '21', '31', '32']

   type :: case_file
      type(material_point_case) :: problem
      real(dp), allocatable :: statev(:)                    !! at the start, however many were given
      character(len=:), allocatable :: library, symbol      !! shared library and entry point of the UMAT
      character(len=:), allocatable :: history, increments, replay   !! names of the files to write
      character(len=:), allocatable :: message              !! what is wrong with the case; empty: nothing
   end type case_file

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
      else if (key == 'temperature') then
         step%temperature = number
         step%heated = .true.
      else if (key /= 'instant') then
         i = 0
         if (len(key) == 3 .and. scan(key(1:1), 'fsp') == 1) i = findloc(component_name, key(2:), dim=1)
         if (i == 0 .or. (i > 3 .and. key(1:1) == 'p') .or. (i > 6 .and. key(1:1) /= 'f')) then
            message = "unknown key '"//key//"' in a step: use duration, instant, temperature, F11 to F32, "// &
                      "S11 to S23, P11, P22, P33"
         else if (step%kind(i) /= kind_held) then
            message = 'component '//component_name(i)//' is prescribed twice: keep one'
         else
            step%kind(i) = merge(kind_deformation, kind_stress, key(1:1) == 'f')
            step%target(i) = merge(-number, number, key(1:1) == 'p')
         end if
      end if
   end subroutine read_step

   pure subroutine read_start(key, value, case)
      character(len=*), intent(in) :: key, value
      type(case_file), intent(inout) :: case
      real(dp), allocatable :: numbers(:)
      real(dp) :: flat(9)
      logical :: valid
      call to_numbers(value, numbers, valid)
      if (.not. valid) then
         case%message = "'"//value//"' is no valid value of '"//key//"'"
         return
      end if
      associate (start => case%problem%start)
         select case (key)
         case ('deformation_gradient', 'first_guess')
            call take_vector(key, numbers, flat, case%message)
            if (len(case%message) > 0) return
            if (key == 'first_guess') case%problem%first_guess = transpose(reshape(flat, [3, 3]))
            if (key /= 'first_guess') start%f = transpose(reshape(flat, [3, 3]))
         case ('stress'); call take_vector(key, numbers, start%stress, case%message)
         case ('strain'); call take_vector(key, numbers, start%stran, case%message)
         case ('energies'); call take_vector(key, numbers, start%energy, case%message)
         case ('statev'); case%statev = [case%statev, numbers]
         case ('pressure'); start%pressure = numbers(1)
         case ('step_time'); start%step_time = numbers(1)
         case ('total_time'); start%total_time = numbers(1)
         case ('step'); start%step = nint(numbers(1))
         case ('increment'); start%increment = nint(numbers(1))
         case default
            case%message = "unknown key '"//key//"' in the start: use deformation_gradient, first_guess, stress, "// &
                           'strain, statev, energies, pressure, step_time, total_time, step or increment'
         end select
      end associate
   end subroutine read_start

   pure subroutine take_vector(name, given, taken, message)
      character(len=*), intent(in) :: name
      real(dp), intent(in) :: given(:)
      real(dp), intent(inout) :: taken(:)
      character(len=:), allocatable, intent(inout) :: message
      character(len=80) :: counts
      if (size(given) == size(taken)) then
         taken = given
      else
         write (counts, '(a,i0,a,i0)') ' has ', size(given), ' values; it needs ', size(taken)
         message = name//trim(counts)
      end if
   end subroutine take_vector

   !! Set the control called `key`; `problem` says what is wrong with it, empty if nothing.
   pure subroutine set_control(c, key, text, problem)
      type(control_settings), intent(inout) :: c
      character(len=*), intent(in) :: key, text
      character(len=:), allocatable, intent(out) :: problem
      real(dp) :: number
      integer :: count
      logical :: switch, is_number, is_switch, known
      call to_number(text, number, is_number)
      call to_logical(text, switch, is_switch)
      count = 0
      if (abs(number) < 2.0e9_dp) count = nint(number)
      known = is_number
      select case (key)
      case ('initial_increment'); c%initial_increment = number
      case ('minimum_increment'); c%minimum_increment = number
      case ('maximum_increment'); c%maximum_increment = number
      case ('growth'); c%growth = number
      case ('cut'); c%cut = number
      case ('strain_tolerance'); c%strain_tolerance = number
      case ('reject_factor'); c%reject_factor = number
      case ('residual_tolerance'); c%residual_tolerance = number
      case ('load_scale'); c%load_scale = number
      case ('rounding_tolerance'); c%rounding_tolerance = number
      case ('largest_correction'); c%largest_correction = number
      case ('easy_iterations'); c%easy_iterations = count
      case ('easy_in_a_row'); c%easy_in_a_row = count
      case ('max_iterations'); c%max_iterations = count
      case ('max_attempts'); c%max_attempts = count
      case ('max_increments'); c%max_increments = count
      case ('constraint_release_statev'); c%release_statev = count
      case ('tangent_check'); c%tangent_check_every = count
      case ('power_newton'); c%power_newton = switch; known = is_switch
      case ('extrapolate'); c%extrapolate = switch; known = is_switch
      case ('incompressible'); c%incompressible = switch; known = is_switch
      case default; known = .false.
      end select
      problem = ''
      if (.not. known) then
         problem = "'"//key//" = "//text//"' is no control: see the list in driver/README.md"
      else if (is_number .and. number < 0.0_dp) then
         problem = "control '"//key//"' is "//text//"; it must not be negative"
      end if
   end subroutine set_control

   !! The block "controls" with what decides the solution of a single increment of size dt.
   subroutine write_controls(unit, controls, dt, load_scale)
      integer, intent(in) :: unit
      type(control_settings), intent(in) :: controls
      real(dp), intent(in) :: dt, load_scale                !! s, MPa
      character(len=*), parameter :: real_line = '(2x,a,es24.16e3)', count_line = '(2x,a,i0)', switch_line = '(2x,2a)'
      write (unit, '(a)') 'begin controls'
      write (unit, real_line) 'initial_increment =', dt, 'minimum_increment =', dt, 'maximum_increment =', dt, &
         'residual_tolerance =', controls%residual_tolerance, 'load_scale =', load_scale, &
         'rounding_tolerance =', controls%rounding_tolerance, 'largest_correction =', controls%largest_correction
      write (unit, count_line) 'max_iterations = ', controls%max_iterations, 'max_attempts = ', 1, &
         'constraint_release_statev = ', controls%release_statev
      write (unit, switch_line) 'power_newton = ', yes_or_no(controls%power_newton), &
         'incompressible = ', yes_or_no(controls%incompressible)
      write (unit, '(a)') 'end controls'
   end subroutine write_controls

   pure function yes_or_no(value) result(text)
      logical, intent(in) :: value
      character(len=:), allocatable :: text
      text = 'no'
      if (value) text = 'yes'
   end function yes_or_no

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
