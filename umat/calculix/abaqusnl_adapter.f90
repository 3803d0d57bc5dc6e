!! A UMAT of Abaqus behind CalculiX's @ABAQUSNL_ door.
!!
!! CalculiX passes the global deformation gradients, but gives and takes the co-rotated stress R^T sigma R, and its tangent
!! is only taken to the reference configuration with U^-1 four times. What that has to be for a UMAT that works in the global
!! basis, with R the rotation at the end of the increment, is
!!
!!     s' = R^T sigma R,    c' = R^T (x)4 [ J DDSDDE - (1/2)(d_ik tau_jl + d_il tau_jk + d_jk tau_il + d_jl tau_ik) ].
!!
!! PNEWDT is -1 in CalculiX unless a smaller increment is wanted; any value above 0 forces a cut. The material card is
!! *MATERIAL, NAME=@ABAQUSNL_<LIBRARY>_PFUMAT; not for use with *ORIENTATION, which this door gets wrong: write the
!! mesh with the fibre along global axis 1, or use the native door.
module plyflow_abaqusnl_adapter
  use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int
  use, intrinsic :: iso_fortran_env, only: real64
  use plyflow_calculix_messages, only: set_quiet
  implicit none
  private
  public :: abaqusnl_umat, co_rotated_tangent, rotation_of

  integer, parameter :: dp = real64
  integer, parameter :: row(6) = [1, 2, 3, 1, 1, 2], col(6) = [1, 2, 3, 2, 3, 3]
  real(dp), parameter :: identity(3, 3) = reshape([1, 0, 0, 0, 1, 0, 0, 0, 1], [3, 3])
  real(dp), parameter :: no_opinion = 1.0e36_dp
  integer, parameter :: last_try = 13

  !! One call of the UMAT: what goes in, and what came out.
  type :: umat_call
    real(dp) :: f_start(3, 3), f_end(3, 3)
    real(dp) :: stress(6), ddsdde(6, 6), pnewdt
    real(dp), allocatable :: statev(:)
  end type umat_call

  interface
    subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, &
                    temp, dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, &
                    pnewdt, celent, dfgrd0, dfgrd1, noel, npt, layer, kspt, kstep, kinc)
      import :: dp
      character(len=80) :: cmname
      integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, kstep(4), kinc
      real(dp) :: stress(ntens), statev(nstatv), ddsdde(ntens, ntens), sse, spd, scd, rpl, ddsddt(ntens), &
        drplde(ntens), drpldt, stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(1), dpred(1), &
        props(nprops), coords(3), drot(3, 3), pnewdt, celent, dfgrd0(3, 3), dfgrd1(3, 3)
    end subroutine umat
  end interface

contains

  !! CalculiX's call, with the arguments of call_external_umat_ in its order.
  !! When the UMAT cannot evaluate the end of the increment (it leaves DDSDDE at zero), CalculiX gets stress and tangent of
  !! the same increment scaled back until it can, the state of the start, and the UMAT's wish for a smaller increment.
  subroutine abaqusnl_umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, &
                           dtime, temp, dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, &
                           coords, drot, pnewdt, celent, dfgrd0, dfgrd1, noel, npt, layer, kspt, kstep, kinc, &
                           name_length) bind(c, name='PFUMAT')
    real(c_double), intent(inout) :: stress(6) !! R^T sigma R at the start, then at the end [MPa]
    integer(c_int), intent(in) :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, kstep(4), kinc
    real(c_double), intent(inout) :: statev(nstatv) !! state at the start, then at the end
    real(c_double), intent(inout) :: ddsdde(6, 6) !! c', see above [MPa]
    real(c_double), intent(inout) :: sse, spd, scd, rpl, ddsddt(6), drplde(6), drpldt
    real(c_double), intent(in) :: stran(6), dstran(6) !! ln U, engineering shears [-]
    real(c_double), intent(in) :: time(2), dtime, temp, dtemp, predef, dpred, props(nprops), coords(3), drot(3, 3)
    character(kind=c_char), intent(in) :: cmname(80)
    real(c_double), intent(inout) :: pnewdt !! -1, or the ratio of a smaller increment
    real(c_double), intent(in) :: celent, dfgrd0(3, 3), dfgrd1(3, 3)
    integer(c_int), value :: name_length
    type(umat_call) :: answer
    real(dp) :: wanted, statev_start(nstatv), stress_start(6)
    integer :: try
    associate (unused_1 => predef, unused_2 => dpred, unused_3 => celent, unused_4 => layer, unused_5 => kspt, &
               unused_6 => name_length, unused_7 => ndi, unused_8 => nshr, unused_9 => ntens)
    end associate
    sse = 0.0_dp; spd = 0.0_dp; scd = 0.0_dp; rpl = 0.0_dp
    ddsddt = 0.0_dp; drplde = 0.0_dp; drpldt = 0.0_dp
    statev_start = statev
    stress_start = stress
    wanted = no_opinion
    do try = 0, last_try
      answer%f_start = dfgrd0
      answer%f_end = part_of_increment(dfgrd0, dfgrd1, try)
      answer%statev = statev_start
      answer%stress = stress_start
      call set_quiet(try > 0)
      call call_umat(answer, [stran, dstran], time, dtime, [temp, dtemp], cmname, props, coords, drot, [noel, npt, kinc], &
                     kstep)
      if (try == 0) wanted = answer%pnewdt
      if (any(abs(answer%ddsdde) > 0.0_dp)) exit
    end do
    call set_quiet(.false.)
    if (try == 0) statev = answer%statev
    call to_calculix(answer, stress, ddsdde)
    if (wanted < 1.0_dp) then
      if (pnewdt > 0.0_dp) wanted = min(wanted, pnewdt)
      pnewdt = wanted
    end if
  end subroutine abaqusnl_umat

  !! The end of the increment, of its half, quarter, ... and, last, its start.
  pure function part_of_increment(f_start, f_end, try) result(f)
    real(dp), intent(in) :: f_start(3, 3), f_end(3, 3)
    integer, intent(in) :: try
    real(dp) :: f(3, 3)
    f = f_end
    if (try > 0) f = f_start + 0.5_dp**try*(f_end - f_start)
    if (try == last_try) f = f_start
  end function part_of_increment

  !! Call the UMAT with the tensors of the start turned to the end of the increment, as Abaqus does.
  subroutine call_umat(answer, strains, time, dtime, temperatures, cmname, props, coords, drot, places, kstep)
    type(umat_call), intent(inout) :: answer
    real(dp), intent(in) :: strains(12) !! ln U at the start and its increment
    real(dp), intent(in) :: time(2), dtime, temperatures(2), props(:), coords(3), drot(3, 3)
    character(kind=c_char), intent(in) :: cmname(80)
    integer, intent(in) :: places(3) !! element, point, increment
    integer, intent(in) :: kstep(4)
    character(len=80) :: name
    real(dp) :: bond(6, 6), stran(6), dstran(6), ddsddt(6), drplde(6), predef(1), dpred(1), copy_drot(3, 3)
    real(dp) :: sse, spd, scd, rpl, drpldt, step_size, temp, dtemp, now(2), constants(size(props)), position(3)
    integer :: i, step(4), place(3)
    do i = 1, 80
      name(i:i) = cmname(i)
    end do
    bond = bond_matrix(rotation_of(answer%f_end))
    answer%stress = matmul(bond, answer%stress)
    stran = strain_of(matmul(bond, tensor_of(strains(1:6))))
    dstran = strain_of(matmul(bond, tensor_of(strains(7:12))))
    answer%ddsdde = 0.0_dp
    answer%pnewdt = no_opinion
    ddsddt = 0.0_dp; drplde = 0.0_dp; predef = 0.0_dp; dpred = 0.0_dp
    sse = 0.0_dp; spd = 0.0_dp; scd = 0.0_dp; rpl = 0.0_dp; drpldt = 0.0_dp
    step_size = dtime; temp = temperatures(1); dtemp = temperatures(2); now = time
    constants = props; position = coords; copy_drot = drot; step = kstep; place = places
    call umat(answer%stress, answer%statev, answer%ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, &
              now, step_size, temp, dtemp, predef, dpred, name, 3, 3, 6, size(answer%statev), constants, size(constants), &
              position, copy_drot, answer%pnewdt, 1.0_dp, answer%f_start, answer%f_end, place(1), place(2), 1, 1, step, &
              place(3))
  end subroutine call_umat

  !! What CalculiX wants from the UMAT's Cauchy stress and DDSDDE.
  subroutine to_calculix(answer, stress, ddsdde)
    type(umat_call), intent(in) :: answer
    real(dp), intent(out) :: stress(6), ddsdde(6, 6)
    real(dp) :: bond(6, 6)
    bond = bond_matrix(transpose(rotation_of(answer%f_end)))
    stress = matmul(bond, answer%stress)
    ddsdde = co_rotated_tangent(answer%f_end, answer%stress, answer%ddsdde)
  end subroutine to_calculix

  !! c' of the head of this file.
  pure function co_rotated_tangent(f, stress, ddsdde) result(tangent)
    real(dp), intent(in) :: f(3, 3), stress(6), ddsdde(6, 6)
    real(dp) :: tangent(6, 6), bond(6, 6), tau(3, 3)
    integer :: n, m
    do n = 1, 6
      tau(row(n), col(n)) = determinant(f)*stress(n)
      tau(col(n), row(n)) = tau(row(n), col(n))
    end do
    do m = 1, 6
      do n = 1, 6
        tangent(n, m) = determinant(f)*ddsdde(n, m) - 0.5_dp* &
          (identity(row(n), row(m))*tau(col(n), col(m)) + identity(row(n), col(m))*tau(col(n), row(m)) &
           + identity(col(n), row(m))*tau(row(n), col(m)) + identity(col(n), col(m))*tau(row(n), row(m)))
      end do
    end do
    bond = bond_matrix(transpose(rotation_of(f)))
    tangent = matmul(bond, matmul(tangent, transpose(bond)))
  end function co_rotated_tangent

  !! Matrix B with (Q T Q^T) = B T for tensor components in the order 11, 22, 33, 12, 13, 23.
  pure function bond_matrix(q) result(bond)
    real(dp), intent(in) :: q(3, 3)
    real(dp) :: bond(6, 6)
    integer :: n, m
    do m = 1, 6
      do n = 1, 6
        bond(n, m) = q(row(n), row(m))*q(col(n), col(m))
        if (m > 3) bond(n, m) = bond(n, m) + q(row(n), col(m))*q(col(n), row(m))
      end do
    end do
  end function bond_matrix

  !! Rotation R of F = R U by averaging F with its inverse transpose until nothing changes; identity if det F <= 0.
  pure function rotation_of(f) result(r)
    real(dp), intent(in) :: f(3, 3)
    real(dp) :: r(3, 3), next(3, 3)
    integer :: i
    r = identity
    if (.not. determinant(f) > 0.0_dp) return
    r = f
    do i = 1, 100
      next = 0.5_dp*(r + cofactor(r)/determinant(r))
      if (maxval(abs(next - r)) <= 4.0_dp*epsilon(1.0_dp)) exit
      r = next
    end do
  end function rotation_of

  pure function cofactor(a) result(c)
    real(dp), intent(in) :: a(3, 3)
    real(dp) :: c(3, 3)
    integer :: j
    do j = 1, 3
      associate (u => a(:, mod(j, 3) + 1), v => a(:, mod(j + 1, 3) + 1))
        c(:, j) = cshift(u, 1)*cshift(v, 2) - cshift(u, 2)*cshift(v, 1)
      end associate
    end do
  end function cofactor

  pure function determinant(a) result(d)
    real(dp), intent(in) :: a(3, 3)
    real(dp) :: d, c(3, 3)
    c = cofactor(a)
    d = dot_product(a(:, 1), c(:, 1))
  end function determinant

  !! Tensor components of a strain with engineering shears, and back.
  pure function tensor_of(strain) result(tensor)
    real(dp), intent(in) :: strain(6)
    real(dp) :: tensor(6)
    tensor = strain
    tensor(4:6) = 0.5_dp*strain(4:6)
  end function tensor_of

  pure function strain_of(tensor) result(strain)
    real(dp), intent(in) :: tensor(6)
    real(dp) :: strain(6)
    strain = tensor
    strain(4:6) = 2.0_dp*tensor(4:6)
  end function strain_of

end module plyflow_abaqusnl_adapter
