!! The unknown components of F, measured from the start of the increment.
module driver_unknowns
   use driver_kinds, only: dp
   use driver_tensors, only: voigt_row, voigt_col
   implicit none
   private
   public :: unknown_set, unknowns_from_start, increments_of, deformation_at, sensitivity

   !! A normal component is written F = F_start exp(q/F_start): det F of an upper triangular F is the product of
   !! its diagonal, so that steps in q keep the volume to all orders and a stiff penalty stays quiet.
   type :: unknown_set
      integer, allocatable :: index(:)                     !! components, 1 to 6
      real(dp), allocatable :: start(:)                    !! F at the start of the increment
      logical, allocatable :: logarithmic(:)               !! else F = F_start + q
   end type unknown_set
contains
   pure function unknowns_from_start(f_start, stress_controlled) result(set)
      real(dp), intent(in) :: f_start(3, 3)
      logical, intent(in) :: stress_controlled(6)
      type(unknown_set) :: set
      integer :: j
      allocate (set%index(count(stress_controlled)))
      allocate (set%start(size(set%index)), set%logarithmic(size(set%index)))
      set%index(:) = pack([1, 2, 3, 4, 5, 6], stress_controlled)
      do j = 1, size(set%index)
         set%start(j) = f_start(voigt_row(set%index(j)), voigt_col(set%index(j)))
      end do
      set%logarithmic(:) = set%index <= 3 .and. set%start > 0.1_dp
   end function unknowns_from_start

   !! q of the components of f; a component that has changed sign counts as not moved.
   pure function increments_of(set, f) result(q)
      type(unknown_set), intent(in) :: set
      real(dp), intent(in) :: f(3, 3)
      real(dp) :: q(size(set%index)), change
      integer :: j
      do j = 1, size(q)
         change = f(voigt_row(set%index(j)), voigt_col(set%index(j))) - set%start(j)
         q(j) = change
         if (.not. set%logarithmic(j)) cycle
         q(j) = 0.0_dp
         if (change > -set%start(j)) q(j) = set%start(j)*log_one_plus(change/set%start(j))
      end do
   end function increments_of

   pure function deformation_at(set, q, prescribed) result(f)
      type(unknown_set), intent(in) :: set
      real(dp), intent(in) :: q(:)
      real(dp), intent(in) :: prescribed(3, 3)             !! supplies the other components
      real(dp) :: f(3, 3), value
      integer :: j
      f = prescribed
      do j = 1, size(set%index)
         value = set%start(j) + q(j)
         if (set%logarithmic(j)) value = set%start(j)*exp(q(j)/set%start(j))
         f(voigt_row(set%index(j)), voigt_col(set%index(j))) = value
      end do
   end function deformation_at

   !! dF/dq of each unknown.
   pure function sensitivity(set, q) result(rate)
      type(unknown_set), intent(in) :: set
      real(dp), intent(in) :: q(:)
      real(dp) :: rate(size(set%index))
      rate = 1.0_dp
      where (set%logarithmic) rate = exp(q(:size(rate))/set%start)
   end function sensitivity

   !! log(1 + x), exact also for x far below rounding of 1.
   pure real(dp) function log_one_plus(x)
      real(dp), intent(in) :: x
      real(dp) :: rounded
      rounded = 1.0_dp + x
      log_one_plus = x
      if (abs(rounded - 1.0_dp) > 0.0_dp) log_one_plus = log(rounded)*(x/(rounded - 1.0_dp))
   end function log_one_plus
end module driver_unknowns
