!! One call of the UMAT for one trial deformation gradient, with everything Abaqus prepares before and reads after.
module driver_material
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_size_t
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use driver_kinds, only: dp, outcome_converged, outcome_inverted, outcome_not_finite, outcome_pnewdt, &
      outcome_stopped, pnewdt_untouched
   use driver_tensors, only: determinant, identity, polar_rotation, rotate_strain, rotate_stress, rotate_tangent, &
      all_finite
   use driver_kinematics, only: strain_and_rotation
   use driver_case, only: material_settings, point_state
   use driver_umat_interface, only: umat_procedure, standin_procedure, umat_at, standin_at, take_messages
   implicit none
   private
   public :: material_point, point_response, connect, evaluate

   type :: material_point
      type(material_settings) :: settings
      procedure(umat_procedure), pointer, nopass :: umat => null()
      procedure(standin_procedure), pointer, nopass :: standin => null()
      integer :: calls = 0
   end type material_point

   type :: point_response
      integer :: outcome = outcome_converged               !! converged means: usable
      character(len=:), allocatable :: message             !! the UMAT's own words
      real(dp) :: f(3, 3) = identity
      real(dp) :: stress(6) = 0.0_dp, ddsdde(6, 6) = 0.0_dp
      real(dp) :: stran(6) = 0.0_dp, dstran(6) = 0.0_dp
      real(dp), allocatable :: statev(:)
      real(dp) :: energy(3) = 0.0_dp
      real(dp) :: pnewdt = pnewdt_untouched
   end type point_response

   !! The frame Abaqus calls in: global, or the basis that turns with the material (*ORIENTATION).
   type :: call_frame
      real(dp) :: f_start(3, 3), f_end(3, 3), drot(3, 3)
      real(dp) :: stress(6), stran(6), dstran(6)
      real(dp) :: to_global(3, 3)
   end type call_frame
contains
   subroutine connect(point, settings)
      type(material_point), intent(out) :: point
      type(material_settings), intent(in) :: settings
      point%settings = settings
      call umat_at(settings%umat_address, point%umat)
      call standin_at(settings%standin_address, point%standin)
   end subroutine connect

   subroutine evaluate(point, start, f_end, dt, response)
      type(material_point), intent(inout) :: point
      type(point_state), intent(in) :: start               !! converged state at the start of the increment
      real(dp), intent(in) :: f_end(3, 3)
      real(dp), intent(in) :: dt                           !! s
      type(point_response), intent(out) :: response
      type(call_frame) :: frame
      response%f = f_end
      response%message = ''
      if (.not. determinant(f_end) > 0.0_dp) then
         response%outcome = outcome_inverted
         return
      end if
      frame = frame_of_call(start, f_end, point%settings%corotated)
      response%stress = frame%stress
      response%statev = start%statev
      response%energy = start%energy
      call call_umat(point, start, frame, dt, response)
      response%stress = rotate_if(point%settings%corotated, response%stress, frame%to_global)
      if (point%settings%corotated) response%ddsdde = rotate_tangent(response%ddsdde, frame%to_global)
      response%dstran = frame%dstran
      response%stran = frame%stran + frame%dstran
      if (point%settings%corotated) then
         response%dstran = rotate_strain(frame%dstran, frame%to_global)
         response%stran = rotate_strain(response%stran, frame%to_global)
      end if
      call judge(point, response)
   end subroutine evaluate

   pure function rotate_if(turn, stress, q) result(turned)
      logical, intent(in) :: turn
      real(dp), intent(in) :: stress(6), q(3, 3)
      real(dp) :: turned(6)
      turned = stress
      if (turn) turned = rotate_stress(stress, q)
   end function rotate_if

   pure function frame_of_call(start, f_end, corotated) result(frame)
      type(point_state), intent(in) :: start
      real(dp), intent(in) :: f_end(3, 3)
      logical, intent(in) :: corotated
      type(call_frame) :: frame
      real(dp) :: turn_start(3, 3), turn_end(3, 3)
      if (corotated) then
         turn_start = transpose(polar_rotation(start%f))
         turn_end = transpose(polar_rotation(f_end))
         frame%f_start = matmul(turn_start, start%f)
         frame%f_end = matmul(turn_end, f_end)
         call strain_and_rotation(frame%f_start, frame%f_end, frame%dstran, frame%drot)
         frame%drot = identity
         frame%stress = rotate_stress(start%stress, turn_start)
         frame%stran = rotate_strain(start%stran, turn_start)
         frame%to_global = transpose(turn_end)
      else
         frame%f_start = start%f
         frame%f_end = f_end
         call strain_and_rotation(start%f, f_end, frame%dstran, frame%drot)
         frame%stress = rotate_stress(start%stress, frame%drot)
         frame%stran = rotate_strain(start%stran, frame%drot)
         frame%to_global = identity
      end if
   end function frame_of_call

   subroutine call_umat(point, start, frame, dt, response)
      type(material_point), intent(inout) :: point
      type(point_state), intent(in) :: start
      type(call_frame), intent(in) :: frame
      real(dp), intent(in) :: dt
      type(point_response), intent(inout) :: response
      integer :: n
      real(dp) :: tangent(point%settings%ntens, point%settings%ntens)
      real(dp) :: rpl, ddsddt(6), drplde(6), drpldt, predef(1), dpred(1), coords(3)
      n = point%settings%ntens
      tangent = 0.0_dp
      rpl = 0.0_dp; ddsddt = 0.0_dp; drplde = 0.0_dp; drpldt = 0.0_dp
      predef = 0.0_dp; dpred = 0.0_dp; coords = 0.0_dp
      response%pnewdt = pnewdt_untouched
      point%calls = point%calls + 1
      call point%umat(response%stress, response%statev, tangent, response%energy(1), response%energy(2), &
                      response%energy(3), rpl, ddsddt, drplde, drpldt, frame%stran, frame%dstran, &
                      [start%step_time, start%total_time], dt, point%settings%temperature, 0.0_dp, predef, dpred, &
                      name_characters(point%settings%name), 3_c_int, int(n - 3, c_int), int(n, c_int), &
                      int(point%settings%n_statev, c_int), point%settings%props, &
                      size(point%settings%props, kind=c_int), coords, frame%drot, response%pnewdt, 1.0_dp, &
                      frame%f_start, frame%f_end, 1_c_int, 1_c_int, 1_c_int, 1_c_int, &
                      [int(start%step, c_int), 1_c_int, 1_c_int, 0_c_int], int(start%increment + 1, c_int), &
                      len(point%settings%name, kind=c_size_t))
      response%ddsdde = 0.0_dp
      response%ddsdde(:n, :n) = tangent
   end subroutine call_umat

   pure function name_characters(name) result(characters)
      character(len=*), intent(in) :: name
      character(kind=c_char) :: characters(len(name))
      integer :: i
      do i = 1, len(name)
         characters(i) = name(i:i)
      end do
   end function name_characters

   !! Order of the verdicts: a stop ends all, a smaller PNEWDT explains whatever else came with it, then NaN.
   subroutine judge(point, response)
      type(material_point), intent(in) :: point
      type(point_response), intent(inout) :: response
      logical :: stop_asked, finite
      call take_messages(point%standin, stop_asked, response%message)
      finite = all_finite(response%stress) .and. all_finite(response%statev) .and. all_finite(response%energy) &
               .and. all_finite(reshape(response%ddsdde, [36]))
      if (stop_asked) then
         response%outcome = outcome_stopped
      else if (response%pnewdt < 1.0_dp) then
         response%outcome = outcome_pnewdt
      else if (.not. finite .or. ieee_is_nan(response%pnewdt)) then
         response%outcome = outcome_not_finite
      end if
   end subroutine judge
end module driver_material
