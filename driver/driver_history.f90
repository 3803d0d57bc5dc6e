!! Growable records of an analysis: accepted states, attempts, residuals.
module driver_history
   use driver_kinds, only: dp
   use driver_tensors, only: determinant, inverse, stress_matrix, times
   use driver_case, only: point_state
   implicit none
   private
   public :: history_record, failed_increment, new_history, add_state, add_attempt, add_residuals

   !! Columns of a state row; the state variables follow from column n_fixed + 1.
   integer, parameter, public :: n_fixed = 33
   integer, parameter, public :: n_attempt = 8

   !! The increment that ended the analysis: enough to call the UMAT again exactly so.
   type :: failed_increment
      real(dp) :: dt = 0.0_dp                              !! s
      real(dp) :: f_end(3, 3) = 0.0_dp
      integer :: outcome = 0
      real(dp) :: f_guess(3, 3) = 0.0_dp
      logical :: stress_controlled(6) = .false.
      real(dp) :: stress_target(6) = 0.0_dp                !! MPa
      real(dp) :: load_scale = 0.0_dp                      !! MPa
   end type failed_increment

   type :: history_record
      integer :: n_states = 0, n_attempts = 0, n_residuals = 0
      real(dp), allocatable :: states(:, :)                !! (n_fixed + n_statev, capacity)
      real(dp), allocatable :: attempts(:, :)              !! (n_attempt, capacity)
      real(dp), allocatable :: residuals(:, :)             !! (2, capacity): row of the state, relative residual
      logical :: completed = .false.
      character(len=:), allocatable :: message             !! why it did not complete; else empty
      character(len=:), allocatable :: warnings            !! what the UMAT said on the way, one a line
      real(dp) :: work(2) = 0.0_dp                         !! trapezoidal and right-endpoint sum, MPa
      real(dp) :: worst_tangent(4) = 0.0_dp                !! relative difference, row of the state, i, j
      real(dp) :: tangent_pair(6, 6, 2) = 0.0_dp           !! there: DDSDDE and its numerical counterpart, MPa
      integer :: umat_calls = 0
      type(failed_increment) :: failure
      type(point_state) :: last                            !! last converged state
   end type history_record
contains
   pure function new_history(n_statev) result(history)
      integer, intent(in) :: n_statev
      type(history_record) :: history
      allocate (history%states(n_fixed + n_statev, 64), history%attempts(n_attempt, 64), history%residuals(2, 256))
      history%message = ''
      history%warnings = ''
   end function new_history

   !! Append one accepted state and the work of its increment.
   pure subroutine add_state(history, state, dt, iterations)
      type(history_record), intent(inout) :: history
      type(point_state), intent(in) :: state
      real(dp), intent(in) :: dt                           !! s
      integer, intent(in) :: iterations
      if (history%n_states > 0) call add_work(history, state)
      history%n_states = history%n_states + 1
      call make_room(history%states, history%n_states)
      history%states(:, history%n_states) = [state%total_time, state%step_time, real(state%step, dp), &
         real(state%increment, dp), dt, real(iterations, dp), reshape(transpose(state%f), [9]), &
         total_stress(state), state%pressure, state%stran, state%energy, history%work, state%statev]
      history%last = state
   end subroutine add_state

   !! External work per reference volume, P : dF with the first Piola-Kirchhoff stress P.
   pure subroutine add_work(history, state)
      type(history_record), intent(inout) :: history
      type(point_state), intent(in) :: state
      real(dp) :: change(3, 3), piola_start(3, 3), piola_end(3, 3)
      change = state%f - history%last%f
      piola_start = first_piola_kirchhoff(history%last)
      piola_end = first_piola_kirchhoff(state)
      history%work(1) = history%work(1) + 0.5_dp*sum((piola_start + piola_end)*change)
      history%work(2) = history%work(2) + sum(piola_end*change)
   end subroutine add_work

   pure function total_stress(state) result(stress)
      type(point_state), intent(in) :: state
      real(dp) :: stress(6)
      stress = state%stress
      stress(1:3) = stress(1:3) + state%pressure
   end function total_stress

   pure function first_piola_kirchhoff(state) result(piola)
      type(point_state), intent(in) :: state
      real(dp) :: piola(3, 3)
      piola = determinant(state%f)*times(stress_matrix(total_stress(state)), transpose(inverse(state%f)))
   end function first_piola_kirchhoff

   !! One line of the increment table: step, increment, attempt, iterations, times at its end, its size, outcome.
   pure subroutine add_attempt(history, line)
      type(history_record), intent(inout) :: history
      real(dp), intent(in) :: line(n_attempt)
      history%n_attempts = history%n_attempts + 1
      call make_room(history%attempts, history%n_attempts)
      history%attempts(:, history%n_attempts) = line
   end subroutine add_attempt

   !! Residuals of the iterations that led to the latest state.
   pure subroutine add_residuals(history, residuals)
      type(history_record), intent(inout) :: history
      real(dp), intent(in) :: residuals(:)
      integer :: i
      do i = 1, size(residuals)
         history%n_residuals = history%n_residuals + 1
         call make_room(history%residuals, history%n_residuals)
         history%residuals(:, history%n_residuals) = [real(history%n_states, dp), residuals(i)]
      end do
   end subroutine add_residuals

   pure subroutine make_room(table, needed)
      real(dp), allocatable, intent(inout) :: table(:, :)
      integer, intent(in) :: needed
      real(dp), allocatable :: larger(:, :)
      if (needed <= size(table, 2)) return
      allocate (larger(size(table, 1), 2*size(table, 2)))
      larger(:, :size(table, 2)) = table
      call move_alloc(larger, table)
   end subroutine make_room
end module driver_history
