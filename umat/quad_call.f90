!! One call of a UMAT that was compiled with every double precision number promoted to quadruple precision: the same
!! generated code with 34 digits, as the witness of rounding. Results come back as the sum of two doubles.
subroutine plyflow_quad_call(f0, f1, dt, n_props, props, n_statev, statev, stress, ddsdde, statev_end, pnewdt) bind(c)
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  implicit none
  integer, parameter :: qp = selected_real_kind(33)
  real(c_double), intent(in) :: f0(3, 3), f1(3, 3) !! deformation gradients
  real(c_double), intent(in) :: dt !! s
  integer(c_int), intent(in), value :: n_props, n_statev
  real(c_double), intent(in) :: props(n_props), statev(n_statev)
  real(c_double), intent(out) :: stress(6, 2) !! MPa: high and low part
  real(c_double), intent(out) :: ddsdde(6, 6, 2) !! MPa: high and low part
  real(c_double), intent(out) :: statev_end(n_statev, 2)
  real(c_double), intent(out) :: pnewdt

  real(qp) :: q_stress(6), q_statev(n_statev), q_ddsdde(6, 6), q_sse, q_spd, q_scd, q_rpl, q_vector(6, 4), q_drpldt
  real(qp) :: q_time(2), q_dt, q_temp, q_dtemp, q_field(1), q_props(n_props), q_coords(3), q_drot(3, 3), q_pnewdt, q_celent
  real(qp) :: q_f0(3, 3), q_f1(3, 3)
  character(len=80) :: name
  external :: umat

  q_stress = 0; q_ddsdde = 0; q_sse = 0; q_spd = 0; q_scd = 0; q_rpl = 0; q_vector = 0; q_drpldt = 0
  q_time = 0; q_temp = 0; q_dtemp = 0; q_field = 0; q_coords = 0; q_drot = 0; q_celent = 0
  q_dt = dt
  q_pnewdt = 1.0e36_qp
  q_statev = statev
  q_props = props
  q_f0 = f0
  q_f1 = f1
  name = 'QUAD'
  call umat(q_stress, q_statev, q_ddsdde, q_sse, q_spd, q_scd, q_rpl, q_vector(:, 1), q_vector(:, 2), q_drpldt, &
            q_vector(:, 3), q_vector(:, 4), q_time, q_dt, q_temp, q_dtemp, q_field, q_field, name, 3, 3, 6, n_statev, &
            q_props, n_props, q_coords, q_drot, q_pnewdt, q_celent, q_f0, q_f1, 1, 1, 1, 1, 1, 1)
  stress(:, 1) = real(q_stress, c_double)
  stress(:, 2) = real(q_stress - stress(:, 1), c_double)
  ddsdde(:, :, 1) = real(q_ddsdde, c_double)
  ddsdde(:, :, 2) = real(q_ddsdde - ddsdde(:, :, 1), c_double)
  statev_end(:, 1) = real(q_statev, c_double)
  statev_end(:, 2) = real(q_statev - statev_end(:, 1), c_double)
  pnewdt = real(q_pnewdt, c_double)
end subroutine plyflow_quad_call
