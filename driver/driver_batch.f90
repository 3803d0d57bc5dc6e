!! One call of a UMAT at each of many material points, shared out over OpenMP threads. The points know nothing of each
!! other: every result is bit for bit that of a single call, whatever the number of threads.
module driver_batch
   !$ use omp_lib, only: omp_get_max_threads
   use driver_kinds, only: dp, address_kind, outcome_inverted
   use driver_tensors, only: determinant, identity
   use driver_umat_interface, only: umat_procedure, standin_procedure, umat_at, standin_at, call_umat, take_messages, &
      outcome_of_call
   implicit none
   private
   public :: call_points, get_point_message, available_threads

   type :: words
      character(len=:), allocatable :: text
   end type words

   character(len=80), parameter :: material_name = 'PLYFLOW'
   type(words), allocatable, save :: messages(:)           !! of the last batch, one a point
contains
   !! Results replace the state of every point; a point's outcome says whether they can be used.
   subroutine call_points(umat_address, standin_address, n_threads, n_points, n_props, n_sets, n_statev, ntens, kinc, props, &
                          temperature, time, dtime, f_start, f_end, stress, statev, energies, ddsdde, pnewdt, outcome, spoken)
      integer(address_kind), intent(in) :: umat_address, standin_address
      integer, intent(in) :: n_threads, n_points, n_props
      integer, intent(in) :: n_sets                        !! of constants: 1, or one a point
      integer, intent(in) :: n_statev, ntens, kinc         !! kinc: number of the increment in its step
      real(dp), intent(in) :: props(n_props, n_sets)
      real(dp), intent(in) :: temperature(n_points)        !! degC
      real(dp), intent(in) :: time(2)                      !! step and total time at the start of the increment, s
      real(dp), intent(in) :: dtime(n_points)              !! s
      real(dp), intent(in) :: f_start(3, 3, n_points), f_end(3, 3, n_points)
      real(dp), intent(inout) :: stress(ntens, n_points)   !! Cauchy, MPa
      real(dp), intent(inout) :: statev(n_statev, n_points)
      real(dp), intent(inout) :: energies(3, n_points)     !! SSE, SPD, SCD, MPa
      real(dp), intent(inout) :: ddsdde(ntens, ntens, n_points), pnewdt(n_points)
      integer, intent(inout) :: outcome(n_points)          !! as in driver_kinds
      integer, intent(inout) :: spoken(n_points)           !! 1: get_point_message has something to tell
      procedure(umat_procedure), pointer :: umat
      procedure(standin_procedure), pointer :: standin
      integer :: i, threads
      logical :: stop_asked
      real(dp), parameter :: zero(6) = 0.0_dp
      threads = max(1, n_threads)
      call umat_at(umat_address, umat)
      call standin_at(standin_address, standin)
      if (allocated(messages)) deallocate (messages)
      allocate (messages(n_points))
      !$omp parallel do num_threads(threads) schedule(static) default(shared) private(i, stop_asked)
      do i = 1, n_points
         call call_umat(umat, material_name, i, 1, kinc, ntens, n_statev, props(:, min(i, n_sets)), temperature(i), &
                        0.0_dp, time, dtime(i), zero, zero, identity, f_start(:, :, i), f_end(:, :, i), stress(:, i), &
                        statev(:, i), energies(:, i), ddsdde(:, :, i), pnewdt(i))
         call take_messages(standin, stop_asked, messages(i)%text)
         spoken(i) = merge(1, 0, allocated(messages(i)%text))
         outcome(i) = outcome_of_call(stop_asked, pnewdt(i), stress(:, i), statev(:, i), energies(:, i), ddsdde(:, :, i))
         if (.not. stop_asked .and. .not. determinant(f_end(:, :, i)) > 0.0_dp) outcome(i) = outcome_inverted
      end do
      !$omp end parallel do
   end subroutine call_points

   !! What the UMAT said at a point (from 1) of the last batch; blank: nothing.
   subroutine get_point_message(point, message)
      integer, intent(in) :: point
      character(len=2048), intent(out) :: message          !! the length spelled out for f90wrap
      message = ''
      if (.not. allocated(messages)) return
      if (point < 1 .or. point > size(messages)) return
      if (allocated(messages(point)%text)) message = messages(point)%text
   end subroutine get_point_message

   !! Threads that OpenMP would take by itself; 1 when the driver was built without it.
   subroutine available_threads(number)
      integer, intent(out) :: number
      number = 1
      !$ number = omp_get_max_threads()
   end subroutine available_threads
end module driver_batch
