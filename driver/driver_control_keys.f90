!! The names of the controls in a case file: read and written here only.
module driver_control_keys
   use driver_kinds, only: dp
   use driver_case, only: control_settings
   use driver_text, only: to_number, to_logical
   implicit none
   private
   public :: set_control, write_controls
contains
   !! Set the control called `key`; `problem` says what is wrong with it, empty if nothing.
   pure subroutine set_control(controls, key, text, problem)
      type(control_settings), intent(inout) :: controls
      character(len=*), intent(in) :: key, text
      character(len=:), allocatable, intent(out) :: problem
      real(dp) :: number
      logical :: switch, is_number, is_switch, known
      call to_number(text, number, is_number)
      call to_logical(text, switch, is_switch)
      problem = ''
      known = .false.
      if (is_switch) call set_switch(controls, key, switch, known)
      if (is_number .and. .not. known) call set_real(controls, key, number, known)
      if (is_number .and. .not. known .and. abs(number) < 2.0e9_dp) call set_count(controls, key, nint(number), known)
      if (.not. known) then
         problem = "'"//key//" = "//text//"' is no control: see the list in driver/README.md"
      else if (is_number .and. number < 0.0_dp) then
         problem = "control '"//key//"' is "//text//"; it must not be negative"
      end if
   end subroutine set_control

   pure subroutine set_real(controls, key, value, known)
      type(control_settings), intent(inout) :: controls
      character(len=*), intent(in) :: key
      real(dp), intent(in) :: value
      logical, intent(out) :: known
      known = .true.
      select case (key)
      case ('initial_increment'); controls%initial_increment = value
      case ('minimum_increment'); controls%minimum_increment = value
      case ('maximum_increment'); controls%maximum_increment = value
      case ('growth'); controls%growth = value
      case ('cut'); controls%cut = value
      case ('strain_tolerance'); controls%strain_tolerance = value
      case ('reject_factor'); controls%reject_factor = value
      case ('residual_tolerance'); controls%residual_tolerance = value
      case ('load_scale'); controls%load_scale = value
      case ('rounding_tolerance'); controls%rounding_tolerance = value
      case ('largest_correction'); controls%largest_correction = value
      case default; known = .false.
      end select
   end subroutine set_real

   pure subroutine set_count(controls, key, value, known)
      type(control_settings), intent(inout) :: controls
      character(len=*), intent(in) :: key
      integer, intent(in) :: value
      logical, intent(out) :: known
      known = .true.
      select case (key)
      case ('easy_iterations'); controls%easy_iterations = value
      case ('easy_in_a_row'); controls%easy_in_a_row = value
      case ('max_iterations'); controls%max_iterations = value
      case ('max_attempts'); controls%max_attempts = value
      case ('max_increments'); controls%max_increments = value
      case ('constraint_release_statev'); controls%release_statev = value
      case ('tangent_check'); controls%tangent_check_every = value
      case default; known = .false.
      end select
   end subroutine set_count

   pure subroutine set_switch(controls, key, value, known)
      type(control_settings), intent(inout) :: controls
      character(len=*), intent(in) :: key
      logical, intent(in) :: value
      logical, intent(out) :: known
      known = .true.
      select case (key)
      case ('power_newton'); controls%power_newton = value
      case ('extrapolate'); controls%extrapolate = value
      case ('pnewdt_when_converged'); controls%pnewdt_when_converged = value
      case ('incompressible'); controls%incompressible = value
      case default; known = .false.
      end select
   end subroutine set_switch

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
         'pnewdt_when_converged = ', yes_or_no(controls%pnewdt_when_converged), &
         'incompressible = ', yes_or_no(controls%incompressible)
      write (unit, '(a)') 'end controls'
   end subroutine write_controls

   pure function yes_or_no(value) result(text)
      logical, intent(in) :: value
      character(len=:), allocatable :: text
      text = 'no'
      if (value) text = 'yes'
   end function yes_or_no
end module driver_control_keys
