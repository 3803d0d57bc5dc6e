!! The face that f90wrap binds: arrays and scalars only. A case is built by begin_case, set_controls, set_start
!! and add_step, run by run_case, and read back by the get_ routines; one case at a time.
module driver_binding
   use driver_kinds, only: dp, address_kind
   use driver_case, only: load_step, control_settings, material_point_case, new_state
   use driver_history, only: history_record, n_fixed, n_attempt
   use driver_analysis, only: run_analysis
   use driver_case_keys, only: case_file
   use driver_case_reader, only: read_case
   use driver_replay, only: write_replay
   implicit none
   private
   public :: begin_case, set_controls, set_start, add_step, run_case, get_sizes, get_states, get_attempts
   public :: load_case_file, get_material, write_replay_file
   public :: get_residuals, get_message, get_summary, get_failure, get_tangents
   type(material_point_case), save :: problem
   type(history_record), save :: history
contains
   subroutine begin_case(umat_address, standin_address, material_name, n_props, props, n_statev, ntens, corotated, &
                         temperature)
      integer(address_kind), intent(in) :: umat_address, standin_address
      character(len=*), intent(in) :: material_name
      integer, intent(in) :: n_props
      real(dp), intent(in) :: props(n_props)
      integer, intent(in) :: n_statev, ntens, corotated
      real(dp), intent(in) :: temperature                  !! degC
      if (allocated(problem%steps)) deallocate (problem%steps)
      if (allocated(problem%first_guess)) deallocate (problem%first_guess)
      problem%material%umat_address = umat_address
      problem%material%standin_address = standin_address
      problem%material%name = material_name
      problem%material%props = props
      problem%material%n_statev = n_statev
      problem%material%ntens = ntens
      problem%material%corotated = corotated /= 0
      problem%material%temperature = temperature
      problem%start = new_state(n_statev)
      problem%controls = control_settings()
   end subroutine begin_case

   subroutine set_controls(increments, tolerances, counts, switches)
      real(dp), intent(in) :: increments(5)                !! initial, minimum, maximum (s), growth, cut
      real(dp), intent(in) :: tolerances(6)                !! residual, load scale, rounding, correction, strain, reject
      integer, intent(in) :: counts(7)                     !! easy, in a row, iterations, attempts, increments, ...
      integer, intent(in) :: switches(4)                   !! power, extrapolate, deferred PNEWDT, incompressible
      associate (c => problem%controls)
         c%initial_increment = increments(1); c%minimum_increment = increments(2)
         c%maximum_increment = increments(3); c%growth = increments(4); c%cut = increments(5)
         c%residual_tolerance = tolerances(1); c%load_scale = tolerances(2)
         c%rounding_tolerance = tolerances(3); c%largest_correction = tolerances(4)
         c%strain_tolerance = tolerances(5); c%reject_factor = tolerances(6)
         c%easy_iterations = counts(1); c%easy_in_a_row = counts(2); c%max_iterations = counts(3)
         c%max_attempts = counts(4); c%max_increments = counts(5); c%release_statev = counts(6)
         c%tangent_check_every = counts(7)
         c%power_newton = switches(1) /= 0; c%extrapolate = switches(2) /= 0
         c%pnewdt_when_converged = switches(3) /= 0; c%incompressible = switches(4) /= 0
      end associate
   end subroutine set_controls

   subroutine set_start(f, stress, n_statev, statev)
      real(dp), intent(in) :: f(3, 3), stress(6)           !! deformation gradient, Cauchy stress (MPa)
      integer, intent(in) :: n_statev
      real(dp), intent(in) :: statev(n_statev)
      problem%start%f = f
      problem%start%stress = stress
      problem%start%statev = statev
   end subroutine set_start

   subroutine add_step(duration, kinds, targets, instant)
      real(dp), intent(in) :: duration                     !! s
      integer, intent(in) :: kinds(9)                      !! 0 held, 1 deformation gradient, 2 Cauchy stress
      real(dp), intent(in) :: targets(9)
      integer, intent(in) :: instant
      type(load_step) :: step
      step = load_step(duration, kinds, targets, instant /= 0)
      if (.not. allocated(problem%steps)) allocate (problem%steps(0))
      problem%steps = [problem%steps, step]
   end subroutine add_step

   !! A case file instead of begin_case, set_controls, set_start and add_step.
   subroutine load_case_file(path, valid)
      character(len=*), intent(in) :: path
      integer, intent(out) :: valid                        !! 0: see get_message
      type(case_file) :: file
      call read_case(path, file)
      problem = file%problem
      history%message = file%message
      history%warnings = ''
      valid = merge(1, 0, len(file%message) == 0)
   end subroutine load_case_file

   subroutine get_material(n_props, props, material_name, temperature)
      integer, intent(in) :: n_props
      real(dp), intent(inout) :: props(n_props)
      character(len=80), intent(out) :: material_name
      real(dp), intent(out) :: temperature                 !! degC
      props = problem%material%props
      material_name = problem%material%name
      temperature = problem%material%temperature
   end subroutine get_material

   !! A case file that repeats the increment the last run failed in.
   subroutine write_replay_file(path, library, symbol, written)
      character(len=*), intent(in) :: path, library, symbol
      integer, intent(out) :: written
      character(len=:), allocatable :: message
      message = ''
      call write_replay(path, library, symbol, problem, history, message)
      written = merge(1, 0, len(message) == 0)
   end subroutine write_replay_file

   subroutine run_case(completed)
      integer, intent(out) :: completed
      call run_analysis(problem, history)
      completed = merge(1, 0, history%completed)
   end subroutine run_case

   subroutine get_sizes(n_columns, n_states, n_attempt_columns, n_attempts, n_residuals, n_props)
      integer, intent(out) :: n_columns, n_states, n_attempt_columns, n_attempts, n_residuals, n_props
      n_columns = n_fixed + problem%material%n_statev
      n_states = history%n_states
      n_attempt_columns = n_attempt
      n_attempts = history%n_attempts
      n_residuals = history%n_residuals
      n_props = size(problem%material%props)
   end subroutine get_sizes

   subroutine get_states(n_columns, n_states, states)
      integer, intent(in) :: n_columns, n_states
      real(dp), intent(inout) :: states(n_columns, n_states)
      states = history%states(:, :n_states)
   end subroutine get_states

   subroutine get_attempts(n_columns, n_attempts, attempts)
      integer, intent(in) :: n_columns, n_attempts
      real(dp), intent(inout) :: attempts(n_columns, n_attempts)
      attempts = history%attempts(:, :n_attempts)
   end subroutine get_attempts

   subroutine get_residuals(n_residuals, residuals)
      integer, intent(in) :: n_residuals
      real(dp), intent(inout) :: residuals(2, n_residuals)
      residuals = history%residuals(:, :n_residuals)
   end subroutine get_residuals

   subroutine get_message(message, warnings)
      character(len=2048), intent(out) :: message, warnings   !! the length spelled out for f90wrap
      message = history%message
      warnings = history%warnings
   end subroutine get_message

   subroutine get_summary(umat_calls, worst_tangent)
      integer, intent(out) :: umat_calls
      real(dp), intent(inout) :: worst_tangent(4)          !! relative difference, row of the state, i, j
      umat_calls = history%umat_calls
      worst_tangent = history%worst_tangent
   end subroutine get_summary

   subroutine get_tangents(ddsdde, numerical)
      real(dp), intent(inout) :: ddsdde(6, 6), numerical(6, 6)   !! MPa, where they differed most
      ddsdde = history%tangent_pair(:, :, 1)
      numerical = history%tangent_pair(:, :, 2)
   end subroutine get_tangents

   subroutine get_failure(f_start, f_end, stress, stran, n_statev, statev, energy, times, numbers)
      real(dp), intent(inout) :: f_start(3, 3), f_end(3, 3), stress(6), stran(6)
      integer, intent(in) :: n_statev
      real(dp), intent(inout) :: statev(n_statev), energy(3)
      real(dp), intent(inout) :: times(3)                  !! step time, total time at the start, size, s
      integer, intent(inout) :: numbers(3)                 !! step, increment, outcome
      f_start = history%last%f
      f_end = history%failure%f_end
      stress = history%last%stress
      stran = history%last%stran
      statev = history%last%statev
      energy = history%last%energy
      times = [history%last%step_time, history%last%total_time, history%failure%dt]
      numbers = [history%last%step, history%last%increment + 1, history%failure%outcome]
   end subroutine get_failure
end module driver_binding
