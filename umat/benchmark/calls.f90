!! Benchmark: calls UMAT many times, half in the squeezing and half in the bleeding stage, at states with shear.
!! usage: calls NUMBER NPROPS NSTATV LOCKED NTENS FIBRE STAGES TEMP; instructions are counted from outside (callgrind), the
!! processor's seconds a call are printed. LOCKED is the place of the state variable `locked` (0: none), FIBRE the axis of
!! the fibre, STAGES 0 for both in turn, 1 or 2 for one of them, TEMP the temperature in degC. Every timed call starts from
!! the state that one increment before it has left, so that scenes with a history use it. Reads NPROPS constants from
!! standard input.
program calls
  use, intrinsic :: iso_c_binding, only: c_char, c_int
  implicit none
  interface
    function standin_take(stop_flag, text, text_length) result(number) bind(c, name='plyflow_standin_take')
      import :: c_char, c_int
      integer(c_int), intent(out) :: stop_flag
      integer(c_int), intent(in), value :: text_length
      character(kind=c_char), intent(out) :: text(text_length)
      integer(c_int) :: number
    end function standin_take
  end interface
  integer, parameter :: dp = kind(1.0d0)
  integer :: number, n_props, n_statev, locked, ntens, fibre, stages, i, stage
  real(dp), allocatable :: props(:), statev(:), stress(:), ddsdde(:, :), zero(:), start(:, :)
  real(dp) :: f0(3, 3, 2), f1(3, 3, 2), sse, spd, scd, rpl, drpldt, pnewdt, celent, check, clock(2), temp
  real(dp) :: time(2), coords(3), drot(3, 3), field(1)
  character(len=80) :: name
  character(kind=c_char) :: said(200)
  integer(c_int) :: stop_flag
  external :: umat

  number = argument(1)
  n_props = argument(2)
  n_statev = argument(3)
  locked = argument(4)
  ntens = argument(5)
  fibre = argument(6)
  stages = argument(7)
  temp = argument(8)
  allocate (props(n_props), statev(n_statev), stress(ntens), ddsdde(ntens, ntens), zero(ntens), &
            start(n_statev, 2))
  read (*, *) props
  name = 'BENCHMARK'
  stress = 0; ddsdde = 0; zero = 0; sse = 0; spd = 0; scd = 0; rpl = 0; drpldt = 0; celent = 1
  time = 0; coords = 0; drot = 0; field = 0; check = 0
  start = 0
  do stage = 1, 2
    call states(stage, fibre, ntens, f0(:, :, stage), f1(:, :, stage))
    if (stages /= 0 .and. stages /= stage) cycle
    statev = 0
    if (locked > 0) statev(locked) = stage - 1
    call umat(stress, statev, ddsdde, sse, spd, scd, rpl, zero, zero, drpldt, zero, zero, time, 1.0e-2_dp, temp, &
              0.0_dp, field, field, name, 3, ntens - 3, ntens, n_statev, props, n_props, coords, drot, pnewdt, celent, &
              2*f0(:, :, stage) - f1(:, :, stage), f0(:, :, stage), 1, 1, 1, 1, 1, 1)
    start(:, stage) = statev
  end do
  call cpu_time(clock(1))
  do i = 1, number
    stage = merge(1 + mod(i, 2), stages, stages == 0)
    statev = start(:, stage)
    pnewdt = 1.0e36_dp
    call umat(stress, statev, ddsdde, sse, spd, scd, rpl, zero, zero, drpldt, zero, zero, time, 1.0e-2_dp, temp, &
              0.0_dp, field, field, name, 3, ntens - 3, ntens, n_statev, props, n_props, coords, drot, pnewdt, celent, &
              f0(:, :, stage), f1(:, :, stage), 1, 1, 1, 1, 1, 2)
    check = check + stress(3) + ddsdde(1, 2)
  end do
  call cpu_time(clock(2))
  if (standin_take(stop_flag, said, 200_c_int) > 0) then
    print *, 'the UMAT refuses the benchmark: ', said(:199)
    error stop 1
  end if
  print '(es24.16, 1x, es12.4)', check, (clock(2) - clock(1))/number

contains

  !! An increment of compaction with shear and a stretched fibre; stage 1 squeezing, 2 bleeding.
  subroutine states(stage, fibre, ntens, f0, f1)
    integer, intent(in) :: stage, fibre, ntens
    real(dp), intent(out) :: f0(3, 3), f1(3, 3)
    real(dp) :: squeezed(3)
    squeezed = [1.001_dp, merge(1.02_dp, 1.16_dp, stage == 1), merge(0.98_dp, 0.84_dp, stage == 1)]
    f0 = 0
    do i = 1, 3
      f0(i, i) = squeezed(1 + modulo(i - fibre, 3))
    end do
    f0(1, 2) = 0.01_dp
    if (ntens == 6) f0(2, 3) = 0.02_dp
    f1 = f0
    f1(1 + modulo(fibre, 3), 1 + modulo(fibre, 3)) = f1(1 + modulo(fibre, 3), 1 + modulo(fibre, 3)) + 1.0e-4_dp
    f1(1 + modulo(fibre + 1, 3), 1 + modulo(fibre + 1, 3)) = f1(1 + modulo(fibre + 1, 3), 1 + modulo(fibre + 1, 3)) &
                                                           - 1.0e-4_dp
  end subroutine states

  integer function argument(place)
    integer, intent(in) :: place
    character(len=32) :: text
    call get_command_argument(place, text)
    read (text, *) argument
  end function argument

end program calls
