!! The face that f90wrap binds: arrays and scalars only. A case is built by begin_case, set_one_control, set_start
!! and add_step, run by run_case, and read back by the get_ routines; one case at a time.
module driver_binding
   use driver_kinds, only: dp, address_kind
   use driver_case, only: load_step, control_settings, material_point_case, new_state, temperature_at, with_temperatures
   use driver_history, only: history_record, n_fixed, n_attempt
   use driver_analysis, only: run_analysis
   use driver_case_keys, only: case_file, set_control
   use driver_case_reader, only: read_case
   use driver_replay, only: write_replay
   implicit none
   private
   public :: begin_case, set_one_control, set_start, add_step, run_case, get_sizes, get_tables
   public :: load_case_file, write_replay_file
   public :: get_message, get_tangents, get_failure
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

   !! One control by its name in a case file.
   subroutine set_one_control(key, text, valid)
      character(len=*), intent(in) :: key, text
      integer, intent(out) :: valid                        !! 0: see get_message
      call set_control(problem%controls, trim(key), trim(text), history%message)
      valid = merge(1, 0, len(history%message) == 0)
   end subroutine set_one_control

   subroutine set_start(f, stress, n_statev, statev)
      real(dp), intent(in) :: f(3, 3), stress(6)           !! deformation gradient, Cauchy stress (MPa)
      integer, intent(in) :: n_statev
      real(dp), intent(in) :: statev(n_statev)
      problem%start%f = f
      problem%start%stress = stress
      problem%start%statev = statev
   end subroutine set_start

   subroutine add_step(duration, kinds, targets, instant, heated, temperature)
      real(dp), intent(in) :: duration                     !! s
      integer, intent(in) :: kinds(9)                      !! 0 held, 1 deformation gradient, 2 Cauchy stress
      real(dp), intent(in) :: targets(9)
      integer, intent(in) :: instant, heated               !! heated 0: the temperature stays
      real(dp), intent(in) :: temperature                  !! degC, at the end of the step
      type(load_step) :: step
      step = load_step(duration, kinds, targets, instant /= 0, heated /= 0, temperature)
      if (.not. allocated(problem%steps)) allocate (problem%steps(0))
      problem%steps = [problem%steps, step]
   end subroutine add_step

   !! A case file instead of begin_case, set_one_control, set_start and add_step.
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

   !! Of the tables of a run, and how often the UMAT was called.
   subroutine get_sizes(n_columns, n_states, n_attempt_columns, n_attempts, n_residuals, n_props, umat_calls)
      integer, intent(out) :: n_columns, n_states, n_attempt_columns, n_attempts, n_residuals, n_props, umat_calls
      n_columns = n_fixed + problem%material%n_statev
      n_states = history%n_states
      n_attempt_columns = n_attempt
      n_attempts = history%n_attempts
      n_residuals = history%n_residuals
      n_props = size(problem%material%props)
      umat_calls = history%umat_calls
   end subroutine get_sizes

   subroutine get_tables(n_columns, n_states, states, n_attempt_columns, n_attempts, attempts, n_residuals, residuals)
      integer, intent(in) :: n_columns, n_states, n_attempt_columns, n_attempts, n_residuals
      real(dp), intent(inout) :: states(n_columns, n_states), attempts(n_attempt_columns, n_attempts)
      real(dp), intent(inout) :: residuals(2, n_residuals)
      states = history%states(:, :n_states)
      attempts = history%attempts(:, :n_attempts)
      residuals = history%residuals(:, :n_residuals)
   end subroutine get_tables

   subroutine get_message(message, warnings)
      character(len=2048), intent(out) :: message, warnings   !! the length spelled out for f90wrap
      message = history%message
      warnings = history%warnings
   end subroutine get_message

   subroutine get_tangents(worst, ddsdde, numerical)
      real(dp), intent(inout) :: worst(4)                  !! relative difference, row of the state, i, j
      real(dp), intent(inout) :: ddsdde(6, 6), numerical(6, 6)   !! MPa, where they differed most
      worst = history%worst_tangent
      ddsdde = history%tangent_pair(:, :, 1)
      numerical = history%tangent_pair(:, :, 2)
   end subroutine get_tangents

   subroutine get_failure(f_start, f_end, stress, stran, n_statev, statev, n_props, props, energy, times, numbers, &
                          material_name, temperature, heating)
      real(dp), intent(inout) :: f_start(3, 3), f_end(3, 3), stress(6), stran(6)
      integer, intent(in) :: n_statev, n_props
      real(dp), intent(inout) :: statev(n_statev), props(n_props), energy(3)
      real(dp), intent(inout) :: times(3)                  !! step time, total time at the start, size, s
      integer, intent(inout) :: numbers(3)                 !! step, increment, outcome
      character(len=80), intent(out) :: material_name
      real(dp), intent(out) :: temperature, heating        !! TEMP, DTEMP, degC
      props = problem%material%props
      material_name = problem%material%name
      temperature = temperature_at(with_temperatures(problem), history%last%total_time)
      heating = temperature_at(with_temperatures(problem), history%last%total_time + history%failure%dt) - temperature
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
