!! One call of a UMAT at each of many material points, shared out over OpenMP threads. The points know nothing of each
!! other: no bit of a result depends on the number of threads or on the neighbours. One by one a result is that of a single
!! call, bit for bit; the batch routine of an emitted UMAT takes blocks of points and differs by the last bits of exp and log.
module driver_batch
   !$ use omp_lib, only: omp_get_max_threads
   use, intrinsic :: iso_c_binding, only: c_f_procpointer, c_null_funptr
   use driver_kinds, only: dp, address_kind, outcome_converged, outcome_inverted, pnewdt_untouched
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
   integer, parameter :: longest_chunk = 512               !! of points, one thread's work at a time

   abstract interface
      !! The batch routine of an emitted UMAT (NAME_batch.f90): results of the points with flagged = 0, nothing of the others.
      subroutine batch_procedure(n, nprops, nstatv, ntens, kinc, props, dtime, f_start, f_end, stresses, states, energies, &
                                 tangents, flagged)
         import :: dp
         integer, intent(in) :: n, nprops, nstatv, ntens, kinc
         real(dp), intent(in) :: props(nprops), dtime(n), f_start(3, 3, n), f_end(3, 3, n)
         real(dp), intent(inout) :: stresses(ntens, n), states(nstatv, n), energies(3, n), tangents(ntens, ntens, n)
         integer, intent(out) :: flagged(n)
      end subroutine batch_procedure
   end interface
   type(words), allocatable, save :: messages(:)           !! of the last batch, one a point
contains
   !! Results replace the state of every point; a point's outcome says whether they can be used.
   subroutine call_points(umat_address, standin_address, batch_address, n_threads, n_points, n_props, n_sets, n_statev, ntens, &
                          kinc, props, temperature, time, dtime, f_start, f_end, stress, statev, energies, ddsdde, pnewdt, &
                          outcome, spoken, in_blocks)
      integer(address_kind), intent(in) :: umat_address, standin_address
      integer(address_kind), intent(in) :: batch_address   !! of the UMAT's batch routine; 0: points go one by one
      integer, intent(in) :: n_threads, n_points, n_props
      integer, intent(in) :: n_sets                        !! of constants: 1, or one a point
      integer, intent(in) :: n_statev, ntens, kinc         !! kinc: number of the increment in its step
      real(dp), intent(in) :: props(n_props, n_sets)
      real(dp), intent(in) :: temperature(n_points)        !! degC
      real(dp), intent(in) :: time(2)                      !! step and total time at the start of the increment, s
      real(dp), intent(in) :: dtime(n_points)              !! s
      real(dp), intent(in) :: f_start(3, 3, n_points), f_end(3, 3, n_points) !! transposed: rows first, as C has them
      real(dp), intent(inout) :: stress(ntens, n_points)   !! Cauchy, MPa
      real(dp), intent(inout) :: statev(n_statev, n_points)
      real(dp), intent(inout) :: energies(3, n_points)     !! SSE, SPD, SCD, MPa
      real(dp), intent(inout) :: ddsdde(ntens, ntens, n_points), pnewdt(n_points)
      integer, intent(inout) :: outcome(n_points)          !! as in driver_kinds
      integer, intent(inout) :: spoken(n_points)           !! 1: get_point_message has something to tell
      integer, intent(out) :: in_blocks                    !! number of points that the batch routine did
      procedure(umat_procedure), pointer :: umat
      procedure(standin_procedure), pointer :: standin
      procedure(batch_procedure), pointer :: batch
      integer :: i, first, last, set, chunk, threads, one_by_one(longest_chunk)
      logical :: stop_asked
      real(dp) :: from(3, 3), to(3, 3)
      real(dp), parameter :: zero(6) = 0.0_dp
      threads = max(1, n_threads)
      call umat_at(umat_address, umat)
      call standin_at(standin_address, standin)
      call batch_at(batch_address, batch)
      if (allocated(messages)) deallocate (messages)
      allocate (messages(n_points))
      chunk = max(8, min(longest_chunk, n_points/threads/8*8))
      in_blocks = 0
      !$omp parallel do num_threads(threads) schedule(static) default(shared) &
      !$omp private(first, last, i, set, stop_asked, one_by_one, from, to) reduction(+: in_blocks)
      do first = 1, n_points, chunk
         last = min(first + chunk - 1, n_points)
         one_by_one = 1
         if (associated(batch)) call call_in_blocks(first, last, one_by_one)
         do i = first, last
            if (one_by_one(i - first + 1) == 0) then
               pnewdt(i) = pnewdt_untouched
               outcome(i) = outcome_converged
               spoken(i) = 0
               in_blocks = in_blocks + 1
               cycle
            end if
            set = min(i, n_sets)
            from = transpose(f_start(:, :, i))
            to = transpose(f_end(:, :, i))
            call call_umat(umat, material_name, i, 1, kinc, ntens, n_statev, props(:, set), temperature(i), time, dtime(i), &
                           zero, zero, identity, from, to, stress(:, i), statev(:, i), energies(:, i), ddsdde(:, :, i), &
                           pnewdt(i))
            call take_messages(standin, stop_asked, messages(i)%text)
            spoken(i) = merge(1, 0, allocated(messages(i)%text))
            outcome(i) = outcome_of_call(stop_asked, pnewdt(i), stress(:, i), statev(:, i), energies(:, i), ddsdde(:, :, i))
            if (.not. stop_asked .and. .not. determinant(to) > 0.0_dp) outcome(i) = outcome_inverted
         end do
      end do
      !$omp end parallel do
   contains
      !! The batch routine for neighbours with the same constants, from the first point to the last.
      subroutine call_in_blocks(first, last, one_by_one)
         integer, intent(in) :: first, last
         integer, intent(inout) :: one_by_one(:)           !! 1: still to be done
         integer :: start, final
         start = first
         do while (start <= last)
            final = last
            if (n_sets > 1) then
               final = start
               do while (final < last)
                  if (.not. all(abs(props(:, final + 1) - props(:, start)) <= 0.0_dp)) exit
                  final = final + 1
               end do
            end if
            call batch(final - start + 1, n_props, n_statev, ntens, kinc, props(:, min(start, n_sets)), dtime(start:), &
                       f_start(:, :, start:), f_end(:, :, start:), stress(:, start:), statev(:, start:), &
                       energies(:, start:), ddsdde(:, :, start:), one_by_one(start - first + 1:))
            start = final + 1
         end do
      end subroutine call_in_blocks
   end subroutine call_points

   subroutine batch_at(address, batch)
      integer(address_kind), intent(in) :: address         !! 0: there is none
      procedure(batch_procedure), pointer, intent(out) :: batch
      nullify (batch)
      if (address /= 0) call c_f_procpointer(transfer(address, c_null_funptr), batch)
   end subroutine batch_at

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
