!! What a user asks of the driver: a material, a programme of steps, and the settings of the solution.
module driver_case
   use driver_kinds, only: dp, address_kind, kind_held, kind_stress
   use driver_tensors, only: determinant, identity
   implicit none
   private
   public :: load_step, control_settings, material_settings, point_state, material_point_case
   public :: new_state, largest_stress_target, validate_case, with_temperatures, temperature_at

   !! Components in the order 11, 22, 33, 12, 13, 23, 21, 31, 32; only the first six can be stress controlled.
   type :: load_step
      real(dp) :: duration = 1.0_dp                        !! s
      integer :: kind(9) = kind_held
      real(dp) :: target(9) = 0.0_dp                       !! deformation gradient (-) or Cauchy stress (MPa)
      logical :: instant = .false.                         !! target holds from the first increment on
      logical :: heated = .false.                          !! the temperature goes to:
      real(dp) :: temperature = 0.0_dp                     !! degC, at the end of the step, reached by a linear ramp
   end type load_step

   type :: control_settings
      real(dp) :: initial_increment = 0.0_dp               !! s; 0: a hundredth of the step
      real(dp) :: minimum_increment = 0.0_dp               !! s; 0: 1e-9 of the step
      real(dp) :: maximum_increment = 0.0_dp               !! s; 0: the step
      real(dp) :: growth = 1.5_dp                          !! factor after easy increments
      real(dp) :: cut = 0.25_dp                            !! factor after a failed attempt
      integer :: easy_iterations = 4                       !! at most so many: easy
      integer :: easy_in_a_row = 2                         !! so many easy ones before growth
      integer :: max_iterations = 16
      integer :: max_attempts = 5                          !! per increment, those ended by PNEWDT < 1 included
      integer :: max_increments = 100000                   !! of the whole analysis
      real(dp) :: strain_tolerance = 0.0_dp                !! like CETOL of *VISCO; 0: off
      real(dp) :: reject_factor = 0.0_dp                   !! reject beyond so many tolerances; 0: never
      real(dp) :: residual_tolerance = 1.0e-6_dp           !! relative to the load scale
      real(dp) :: load_scale = 0.0_dp                      !! MPa; 0: largest stress target of the history
      real(dp) :: rounding_tolerance = 1.0e-3_dp           !! residual accepted once corrections are rounding of F
      real(dp) :: largest_correction = 0.5_dp              !! of a component of F in one iteration
      logical :: power_newton = .true.
      logical :: extrapolate = .true.
      logical :: incompressible = .false.                  !! exact multiplier: det F = 1
      integer :: release_statev = 0                        !! STATEV that releases the multiplier at 0.5; 0: none
      integer :: tangent_check_every = 0                   !! compare DDSDDE every so many increments; 0: never
   end type control_settings

   type :: material_settings
      integer(address_kind) :: umat_address = 0
      integer(address_kind) :: standin_address = 0         !! accessor of the UMAT's messages; 0: none
      character(len=80) :: name = 'MATERIAL'
      real(dp), allocatable :: props(:)
      integer :: n_statev = 0
      integer :: ntens = 6                                 !! 6, or 4 for plane strain and axisymmetric calls
      logical :: corotated = .false.                       !! pass the local basis, as with *ORIENTATION
      real(dp) :: temperature = 0.0_dp                     !! degC, at the start
      real(dp), allocatable :: marks(:), temperatures(:)   !! s of total time, degC: see with_temperatures
   end type material_settings

   !! Everything that is carried from one increment to the next.
   type :: point_state
      real(dp) :: f(3, 3) = identity                       !! deformation gradient
      real(dp) :: stress(6) = 0.0_dp                       !! Cauchy stress of the UMAT, global axes, MPa
      real(dp) :: pressure = 0.0_dp                        !! multiplier added to the normal stresses, MPa
      real(dp) :: stran(6) = 0.0_dp
      real(dp), allocatable :: statev(:)
      real(dp) :: energy(3) = 0.0_dp                       !! SSE, SPD, SCD, MPa
      real(dp) :: step_time = 0.0_dp, total_time = 0.0_dp  !! s
      integer :: step = 1, increment = 0
   end type point_state

   type :: material_point_case
      type(material_settings) :: material
      type(control_settings) :: controls
      type(load_step), allocatable :: steps(:)
      type(point_state) :: start
      real(dp), allocatable :: first_guess(:, :)           !! of F at the end of the very first increment
   end type material_point_case
contains
   pure function new_state(n_statev) result(state)
      integer, intent(in) :: n_statev
      type(point_state) :: state
      allocate (state%statev(n_statev), source=0.0_dp)
   end function new_state

   !! The material of a case with the temperature at the start and at the end of each step.
   pure function with_temperatures(problem) result(material)
      type(material_point_case), intent(in) :: problem
      type(material_settings) :: material
      integer :: i
      material = problem%material
      material%marks = [problem%start%total_time]
      material%temperatures = [material%temperature]
      if (.not. allocated(problem%steps)) return
      do i = 1, size(problem%steps)
         associate (step => problem%steps(i))
            material%marks = [material%marks, material%marks(i) + step%duration]
            material%temperatures = [material%temperatures, merge(step%temperature, material%temperatures(i), step%heated)]
         end associate
      end do
   end function with_temperatures

   !! Temperature at a total time (s), linear between the marks, degC.
   pure real(dp) function temperature_at(material, time)
      type(material_settings), intent(in) :: material
      real(dp), intent(in) :: time
      integer :: i
      real(dp) :: share
      temperature_at = material%temperatures(1)
      if (size(material%marks) == 1) return
      i = max(1, min(count(material%marks <= time), size(material%marks) - 1))
      associate (t => material%marks, value => material%temperatures)
         share = min(max((time - t(i))/(t(i + 1) - t(i)), 0.0_dp), 1.0_dp)
         temperature_at = value(i) + share*(value(i + 1) - value(i))
      end associate
   end function temperature_at

   !! Largest stress asked for in the whole history: the scale of residuals, never the current small load.
   pure real(dp) function largest_stress_target(steps)
      type(load_step), intent(in) :: steps(:)
      integer :: i
      largest_stress_target = 0.0_dp
      do i = 1, size(steps)
         largest_stress_target = max(largest_stress_target, &
                                     maxval(abs(steps(i)%target), mask=steps(i)%kind == kind_stress))
      end do
   end function largest_stress_target

   !! First thing wrong with a case that can be seen before it runs; empty: nothing.
   pure function validate_case(problem) result(message)
      type(material_point_case), intent(in) :: problem
      character(len=:), allocatable :: message
      integer :: i
      message = ''
      if (.not. allocated(problem%steps)) then
         message = 'the case has no step: add at least one'
      else if (.not. determinant(problem%start%f) > 0.0_dp) then
         message = 'the deformation gradient at the start has no positive determinant'
      else if (problem%material%ntens /= 6 .and. problem%material%ntens /= 4) then
         message = 'ntens must be 6 or 4 (plane stress is not offered)'
      else if (problem%controls%release_statev > problem%material%n_statev) then
         message = 'constraint_release_statev lies beyond the state variables'
      else
         do i = 1, size(problem%steps)
            if (len(message) == 0) message = validate_step(problem, i)
         end do
      end if
   end function validate_case

   pure function validate_step(problem, number) result(message)
      type(material_point_case), intent(in) :: problem
      integer, intent(in) :: number
      character(len=:), allocatable :: message
      character(len=12) :: label
      write (label, '(a,i0,a)') 'step ', number, ': '
      message = ''
      associate (step => problem%steps(number))
         if (.not. step%duration > 0.0_dp) then
            message = trim(label)//' the duration must be positive'
         else if (any(step%kind(7:9) == kind_stress)) then
            message = trim(label)//' components 21, 31, 32 take no stress: prescribe 12, 13, 23'
         else if (problem%controls%incompressible .and. .not. any(step%kind == kind_stress)) then
            message = trim(label)//' the incompressibility multiplier needs a component with prescribed stress'
         else if (problem%material%ntens == 4 .and. any(step%kind([5, 6]) == kind_stress)) then
            message = trim(label)//' with ntens = 4 the components 13 and 23 take no stress'
         end if
      end associate
   end function validate_step
end module driver_case
