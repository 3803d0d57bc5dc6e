!! What Abaqus derives from DFGRD0 and DFGRD1 before it calls a UMAT: strain and rotation of the increment.
module driver_kinematics
   use driver_kinds, only: dp
   use driver_tensors, only: determinant, inverse, identity, symmetric_part, skew_part, polar_rotation, strain_voigt, &
      times, turned
   implicit none
   private
   public :: strain_and_rotation
contains
   !! Hughes and Winget (1980): gradient of the displacement increment at the middle of the increment,
   !! strain from its symmetric part, rotation by Cayley's map of the skew part.
   pure subroutine strain_and_rotation(f_start, f_end, dstran, drot)
      real(dp), intent(in) :: f_start(3, 3), f_end(3, 3)   !! deformation gradients, det > 0
      real(dp), intent(out) :: dstran(6)                   !! strain increment, engineering shears
      real(dp), intent(out) :: drot(3, 3)                  !! rotation increment
      real(dp) :: f_middle(3, 3), gradient(3, 3), half_spin(3, 3)
      f_middle = 0.5_dp*(f_start + f_end)
      if (determinant(f_middle) < 1.0e-3_dp*min(determinant(f_start), determinant(f_end))) then
         call strain_and_rotation_polar(f_start, f_end, dstran, drot)
         return
      end if
      gradient = times(f_end - f_start, inverse(f_middle))
      half_spin = 0.5_dp*skew_part(gradient)
      dstran = strain_voigt(symmetric_part(gradient))
      drot = times(inverse(identity - half_spin), identity + half_spin)
   end subroutine strain_and_rotation

   !! A half turn in one increment has no middle configuration: split R U first, take the midpoint rule for U alone.
   pure subroutine strain_and_rotation_polar(f_start, f_end, dstran, drot)
      real(dp), intent(in) :: f_start(3, 3), f_end(3, 3)
      real(dp), intent(out) :: dstran(6), drot(3, 3)
      real(dp) :: relative(3, 3), stretch(3, 3), strain(3, 3)
      relative = times(f_end, inverse(f_start))
      drot = polar_rotation(relative)
      stretch = symmetric_part(times(transpose(drot), relative))
      strain = 2.0_dp*times(stretch - identity, inverse(stretch + identity))
      dstran = strain_voigt(symmetric_part(turned(strain, drot)))
   end subroutine strain_and_rotation_polar
end module driver_kinematics
