!! Dense LU with row equilibration and partial pivoting: the systems here have at most seven unknowns.
module driver_linear_solver
   use driver_kinds, only: dp
   implicit none
   private
   public :: lu_factor, lu_solve, linear_factors

   type :: linear_factors
      real(dp), allocatable :: lu(:, :)              !! unit lower and upper factor of the scaled, permuted matrix
      real(dp), allocatable :: row_scale(:)          !! 1 / largest magnitude of each row
      integer, allocatable :: pivot(:)               !! row taken at each elimination step
   end type linear_factors
contains
   pure subroutine lu_factor(matrix, factors, singular)
      real(dp), intent(in) :: matrix(:, :)
      type(linear_factors), intent(out) :: factors
      logical, intent(out) :: singular               !! a pivot below rounding of its column (or NaN)
      integer :: n, k, i, best
      n = size(matrix, 1)
      allocate (factors%row_scale(n), factors%pivot(n))
      factors%row_scale = maxval(abs(matrix), dim=2)
      singular = .not. all(factors%row_scale > 0.0_dp)
      if (singular) return
      factors%row_scale = 1.0_dp/factors%row_scale
      factors%lu = matrix*spread(factors%row_scale, 2, n)
      do k = 1, n
         best = k - 1 + maxloc(abs(factors%lu(k:n, k)), dim=1)
         singular = .not. abs(factors%lu(best, k)) > 100.0_dp*tiny(1.0_dp)
         if (singular) return
         factors%pivot(k) = best
         factors%lu([k, best], :) = factors%lu([best, k], :)
         do i = k + 1, n
            factors%lu(i, k) = factors%lu(i, k)/factors%lu(k, k)
            factors%lu(i, k + 1:n) = factors%lu(i, k + 1:n) - factors%lu(i, k)*factors%lu(k, k + 1:n)
         end do
      end do
   end subroutine lu_factor

   pure function lu_solve(factors, right_side) result(x)
      type(linear_factors), intent(in) :: factors
      real(dp), intent(in) :: right_side(:)
      real(dp) :: x(size(right_side)), kept
      integer :: n, k
      n = size(right_side)
      x = right_side*factors%row_scale
      do k = 1, n
         kept = x(k)
         x(k) = x(factors%pivot(k))
         x(factors%pivot(k)) = kept
      end do
      do k = 2, n
         x(k) = x(k) - dot_product(factors%lu(k, 1:k - 1), x(1:k - 1))
      end do
      do k = n, 1, -1
         x(k) = (x(k) - dot_product(factors%lu(k, k + 1:n), x(k + 1:n)))/factors%lu(k, k)
      end do
   end function lu_solve
end module driver_linear_solver
