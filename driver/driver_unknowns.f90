!! The unknown components of F, measured from the start of the increment, and the Jacobian of the stresses with respect to them.
module driver_unknowns
   use driver_kinds, only: dp
   use driver_tensors, only: determinant, inverse, symmetric_part, skew_part, strain_voigt, stress_matrix, &
      stress_voigt, times, trace, voigt_row, voigt_col
   use driver_material, only: point_response
   implicit none
   private
   public :: unknown_set, unknowns_from_start, increments_of, deformation_at, sensitivity, bordered_jacobian

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

   !! d(residual)/d(unknowns) exactly from DDSDDE: for dF, L = dF F^-1, D = sym L, W = skew L,
   !! d sigma = DDSDDE:D + W sigma - sigma W - sigma tr D; d det F = det F tr D.
   pure function bordered_jacobian(response, free, rate, constrained) result(jacobian)
      type(point_response), intent(in) :: response
      integer, intent(in) :: free(:)                       !! unknown components of F
      real(dp), intent(in) :: rate(:)                      !! dF/dq of each
      logical, intent(in) :: constrained                   !! last row: det F, last column: the pressure
      real(dp), allocatable :: jacobian(:, :)
      real(dp) :: gradient(3, 3), f_inverse(3, 3), change(6)
      integer :: j, n, m
      n = size(free)
      m = merge(n + 1, n, constrained)
      allocate (jacobian(m, m), source=0.0_dp)
      f_inverse = inverse(response%f)
      do j = 1, n
         gradient = 0.0_dp
         gradient(voigt_row(free(j)), :) = rate(j)*f_inverse(voigt_col(free(j)), :)
         change = stress_rate(response, gradient)
         jacobian(:n, j) = change(free)
         if (constrained) jacobian(m, j) = determinant(response%f)*trace(gradient)
      end do
      if (constrained) jacobian(:n, m) = merge(1.0_dp, 0.0_dp, free <= 3)
   end function bordered_jacobian

   pure function stress_rate(response, gradient) result(rate)
      type(point_response), intent(in) :: response
      real(dp), intent(in) :: gradient(3, 3)               !! L
      real(dp) :: rate(6), spin(3, 3), stress(3, 3)
      spin = skew_part(gradient)
      stress = stress_matrix(response%stress)
      rate = matmul(response%ddsdde, strain_voigt(symmetric_part(gradient))) &
             + stress_voigt(times(spin, stress) - times(stress, spin)) - trace(gradient)*response%stress
   end function stress_rate
end module driver_unknowns
