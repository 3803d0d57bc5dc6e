!! One call of the UMAT for one trial deformation gradient, with everything Abaqus prepares before and reads after.
module driver_material
   use driver_kinds, only: dp, outcome_converged, outcome_inverted, pnewdt_untouched
   use driver_tensors, only: determinant, identity, polar_rotation, rotate_strain, rotate_stress, rotate_tangent
   use driver_kinematics, only: strain_and_rotation
   use driver_case, only: material_settings, point_state, temperature_at
   use driver_umat_interface, only: umat_procedure, standin_procedure, umat_at, standin_at, call_umat, &
      take_messages, outcome_of_call
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
      real(dp) :: tangent(point%settings%ntens, point%settings%ntens)
      real(dp) :: temperature                              !! degC, at the start of the increment
      logical :: stop_asked
      integer :: n
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
      point%calls = point%calls + 1
      n = point%settings%ntens
      temperature = temperature_at(point%settings, start%total_time)
      call call_umat(point%umat, point%settings%name, 1, start%step, start%increment + 1, n, point%settings%n_statev, &
                     point%settings%props, temperature, temperature_at(point%settings, start%total_time + dt) - temperature, &
                     [start%step_time, start%total_time], dt, &
                     frame%stran, frame%dstran, frame%drot, frame%f_start, frame%f_end, response%stress(:n), &
                     response%statev, response%energy, tangent, response%pnewdt)
      response%ddsdde(:n, :n) = tangent
      response%dstran = frame%dstran
      response%stran = frame%stran + frame%dstran
      if (point%settings%corotated) then
         response%stress = rotate_stress(response%stress, frame%to_global)
         response%ddsdde = rotate_tangent(response%ddsdde, frame%to_global)
         response%dstran = rotate_strain(frame%dstran, frame%to_global)
         response%stran = rotate_strain(response%stran, frame%to_global)
      end if
      call take_messages(point%standin, stop_asked, response%message)
      response%outcome = outcome_of_call(stop_asked, response%pnewdt, response%stress, response%statev, response%energy, &
                                         response%ddsdde)
   end subroutine evaluate

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
end module driver_material
