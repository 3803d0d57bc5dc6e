!! One call of a UMAT at each of many material points, shared out over OpenMP threads. The points know nothing of each
!! other: every result is bit for bit that of a single call, whatever the number of threads.
module driver_batch
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char, c_size_t
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   !$ use omp_lib, only: omp_get_max_threads
   use driver_kinds, only: dp, address_kind, text_length, pnewdt_untouched, outcome_converged, outcome_inverted, &
      outcome_not_finite, outcome_pnewdt, outcome_stopped
   use driver_tensors, only: determinant, all_finite
   use driver_umat_interface, only: umat_procedure, standin_procedure, umat_at, standin_at
   implicit none
   private
   public :: call_points, get_point_message, available_threads

   type :: words
      character(len=:), allocatable :: text
   end type words

   character(len=*), parameter :: material_name = 'PLYFLOW'
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
      logical :: stop_asked, finite
      threads = max(1, n_threads)
      call umat_at(umat_address, umat)
      call standin_at(standin_address, standin)
      if (allocated(messages)) deallocate (messages)
      allocate (messages(n_points))
      !$omp parallel do num_threads(threads) schedule(static) default(shared) private(i, stop_asked, finite)
      do i = 1, n_points
         ddsdde(:, :, i) = 0.0_dp
         pnewdt(i) = pnewdt_untouched
         call call_point(umat, i, ntens, kinc, n_statev, props(:, min(i, n_sets)), temperature(i), time, dtime(i), &
                         f_start(:, :, i), f_end(:, :, i), stress(:, i), statev(:, i), energies(:, i), &
                         ddsdde(:, :, i), pnewdt(i))
         call take_words(standin, stop_asked, messages(i))
         finite = all_finite(stress(:, i)) .and. all_finite(statev(:, i)) .and. all_finite(energies(:, i)) &
                  .and. all_finite(reshape(ddsdde(:, :, i), [ntens*ntens]))
         spoken(i) = merge(1, 0, allocated(messages(i)%text))
         outcome(i) = verdict(stop_asked, pnewdt(i), determinant(f_end(:, :, i)), finite)
      end do
      !$omp end parallel do
   end subroutine call_points

   subroutine call_point(umat, number, ntens, kinc, n_statev, props, temperature, time, dtime, f_start, f_end, stress, statev, &
                         energy, ddsdde, pnewdt)
      procedure(umat_procedure), pointer, intent(in) :: umat
      integer, intent(in) :: number, ntens, kinc, n_statev
      real(dp), contiguous, intent(in) :: props(:)
      real(dp), intent(in) :: temperature, time(2), dtime, f_start(3, 3), f_end(3, 3)
      real(dp), intent(inout) :: stress(ntens), statev(n_statev), energy(3), ddsdde(ntens, ntens), pnewdt
      character(kind=c_char) :: name(80)
      real(dp) :: zero(6), rpl, ddsddt(6), drplde(6), drpldt, drot(3, 3)
      integer :: i
      name = ' '
      do i = 1, len(material_name)
         name(i) = material_name(i:i)
      end do
      zero = 0.0_dp; rpl = 0.0_dp; ddsddt = 0.0_dp; drplde = 0.0_dp; drpldt = 0.0_dp
      drot = reshape([1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], [3, 3])
      call umat(stress, statev, ddsdde, energy(1), energy(2), energy(3), rpl, ddsddt, drplde, drpldt, zero, zero, &
                time, dtime, temperature, 0.0_dp, zero, zero, name, 3_c_int, int(ntens - 3, c_int), &
                int(ntens, c_int), int(n_statev, c_int), props, size(props, kind=c_int), zero, drot, pnewdt, 1.0_dp, &
                f_start, f_end, int(number, c_int), 1_c_int, 1_c_int, 1_c_int, [1_c_int, 1_c_int, 1_c_int, 0_c_int], &
                int(kinc, c_int), 80_c_size_t)
   end subroutine call_point

   !! As `take_messages`, without touching the text when there is none: the usual case.
   subroutine take_words(standin, stop_asked, said)
      procedure(standin_procedure), pointer, intent(in) :: standin
      logical, intent(out) :: stop_asked
      type(words), intent(inout) :: said
      character(kind=c_char) :: buffer(text_length)
      integer(c_int) :: flag
      integer :: length, i
      stop_asked = .false.
      if (.not. associated(standin)) return
      flag = 0
      if (standin(flag, buffer, int(text_length, c_int)) > 0) then
         length = 0
         do while (length < text_length - 1 .and. buffer(length + 1) /= c_null_char)
            length = length + 1
         end do
         allocate (character(len=length) :: said%text)
         do i = 1, length
            said%text(i:i) = buffer(i)
         end do
      end if
      stop_asked = flag /= 0
   end subroutine take_words

   pure integer function verdict(stop_asked, pnewdt, volume_ratio, finite)
      logical, intent(in) :: stop_asked, finite
      real(dp), intent(in) :: pnewdt, volume_ratio
      verdict = outcome_converged
      if (stop_asked) then
         verdict = outcome_stopped
      else if (.not. volume_ratio > 0.0_dp) then
         verdict = outcome_inverted
      else if (pnewdt < 1.0_dp) then
         verdict = outcome_pnewdt
      else if (.not. finite .or. ieee_is_nan(pnewdt)) then
         verdict = outcome_not_finite
      end if
   end function verdict

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
