!! 3 by 3 tensors and their Voigt forms (11, 22, 33, 12, 13, 23; engineering shear strains).
module driver_tensors
   use driver_kinds, only: dp
   implicit none
   private
   integer, parameter, public :: voigt_row(9) = [1, 2, 3, 1, 1, 2, 2, 3, 3]
   integer, parameter, public :: voigt_col(9) = [1, 2, 3, 2, 3, 3, 1, 1, 2]
   real(dp), parameter, public :: identity(3, 3) = &
      reshape([1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], [3, 3])
   public :: determinant, inverse, times, turned, trace, symmetric_part, skew_part, polar_rotation
   public :: stress_matrix, stress_voigt, strain_matrix, strain_voigt, rotate_stress, rotate_strain, rotate_tangent
contains
   pure real(dp) function determinant(a)
      real(dp), intent(in) :: a(3, 3)
      determinant = a(1, 1)*(a(2, 2)*a(3, 3) - a(2, 3)*a(3, 2)) &
                  - a(1, 2)*(a(2, 1)*a(3, 3) - a(2, 3)*a(3, 1)) &
                  + a(1, 3)*(a(2, 1)*a(3, 2) - a(2, 2)*a(3, 1))
   end function determinant

   pure function inverse(a) result(b)
      real(dp), intent(in) :: a(3, 3)                !! must not be singular: the caller has looked
      real(dp) :: b(3, 3)
      integer :: i, j, i1, i2, j1, j2
      do j = 1, 3
         do i = 1, 3
            i1 = modulo(i, 3) + 1; i2 = modulo(i + 1, 3) + 1
            j1 = modulo(j, 3) + 1; j2 = modulo(j + 1, 3) + 1
            b(j, i) = a(i1, j1)*a(i2, j2) - a(i1, j2)*a(i2, j1)
         end do
      end do
      b = b/determinant(a)
   end function inverse

   pure function times(a, b) result(c)
      real(dp), intent(in) :: a(3, 3), b(3, 3)
      real(dp) :: c(3, 3)
      c = matmul(a, b)
   end function times

   !! q a q^T
   pure function turned(a, q) result(b)
      real(dp), intent(in) :: a(3, 3), q(3, 3)
      real(dp) :: b(3, 3)
      b = times(q, times(a, transpose(q)))
   end function turned

   pure real(dp) function trace(a)
      real(dp), intent(in) :: a(3, 3)
      trace = a(1, 1) + a(2, 2) + a(3, 3)
   end function trace

   pure function symmetric_part(a) result(s)
      real(dp), intent(in) :: a(3, 3)
      real(dp) :: s(3, 3)
      s = 0.5_dp*(a + transpose(a))
   end function symmetric_part

   pure function skew_part(a) result(w)
      real(dp), intent(in) :: a(3, 3)
      real(dp) :: w(3, 3)
      w = 0.5_dp*(a - transpose(a))
   end function skew_part

   !! Rotation R of F = R U by Newton's iteration R <- (R + R^-T)/2, quadratic from any F with det F > 0.
   pure function polar_rotation(f) result(r)
      real(dp), intent(in) :: f(3, 3)                !! deformation gradient, det > 0
      real(dp) :: r(3, 3), previous(3, 3)
      integer :: iteration
      r = f
      do iteration = 1, 60
         previous = r
         r = 0.5_dp*(previous + transpose(inverse(previous)))
         if (maxval(abs(r - previous)) < 4.0_dp*epsilon(1.0_dp)) exit
      end do
   end function polar_rotation

   pure function stress_matrix(v) result(a)
      real(dp), intent(in) :: v(6)
      real(dp) :: a(3, 3)
      a = reshape([v(1), v(4), v(5), v(4), v(2), v(6), v(5), v(6), v(3)], [3, 3])
   end function stress_matrix

   pure function stress_voigt(a) result(v)
      real(dp), intent(in) :: a(3, 3)                !! symmetric
      real(dp) :: v(6)
      v = [a(1, 1), a(2, 2), a(3, 3), a(1, 2), a(1, 3), a(2, 3)]
   end function stress_voigt

   pure function strain_matrix(v) result(a)
      real(dp), intent(in) :: v(6)                   !! engineering shears
      real(dp) :: a(3, 3)
      a = stress_matrix([v(1:3), 0.5_dp*v(4:6)])
   end function strain_matrix

   pure function strain_voigt(a) result(v)
      real(dp), intent(in) :: a(3, 3)                !! symmetric
      real(dp) :: v(6)
      v = stress_voigt(a)
      v(4:6) = 2.0_dp*v(4:6)
   end function strain_voigt

   pure function rotate_stress(v, q) result(w)
      real(dp), intent(in) :: v(6), q(3, 3)
      real(dp) :: w(6)
      w = stress_voigt(turned(stress_matrix(v), q))
   end function rotate_stress

   pure function rotate_strain(v, q) result(w)
      real(dp), intent(in) :: v(6), q(3, 3)
      real(dp) :: w(6)
      w = strain_voigt(turned(strain_matrix(v), q))
   end function rotate_strain

   !! Stiffness seen from axes turned by q: stress = Q C Q^-1 strain, column by column; no symmetry is assumed.
   pure function rotate_tangent(c, q) result(d)
      real(dp), intent(in) :: c(6, 6), q(3, 3)
      real(dp) :: d(6, 6), unit_strain(6)
      integer :: j
      do j = 1, 6
         unit_strain = 0.0_dp
         unit_strain(j) = 1.0_dp
         d(:, j) = rotate_stress(matmul(c, rotate_strain(unit_strain, transpose(q))), q)
      end do
   end function rotate_tangent
end module driver_tensors
