!! The law written out by hand in 3 by 3 matrices: what a careful engineer would code from the paper. Shared by the peers,
!! which differ in how they come by DDSDDE. PROPS and STATEV are those of the scene bdf1; fibre along axis 1,
!! ply normal along axis 3.
module peer_law
   use peer_places
   implicit none
   integer, parameter :: dp = kind(1.0d0)
contains

   !! Second Piola-Kirchhoff stress, coefficients and bookkeeping of one increment.
   subroutine law_stress(f0, f1, dt, props, locked, in_plane, c, c_inverse, c_rate, g, slopes, scalars, s, fault)
      real(dp), intent(in) :: f0(3, 3), f1(3, 3), dt, props(n_props)
      logical, intent(in) :: locked                           !! bleeding
      real(dp), intent(out) :: c(3, 3), c_inverse(3, 3)       !! right Cauchy-Green tensor
      real(dp), intent(in) :: in_plane                        !! weight of the rates in the ply plane in J2
      real(dp), intent(out) :: c_rate(3, 3)                   !! (C1 - C0)/dt, 1/s
      real(dp), intent(out) :: g                              !! S_v = g Cdot, MPa s
      real(dp), intent(out) :: slopes(3, 3)                   !! 2 d ln g/dC
      real(dp), intent(out) :: scalars(8)                     !! J, stretch, width, rate, kappa, J2, floor of J2, A:A
      real(dp), intent(out) :: s(3, 3)                        !! MPa
      logical, intent(out) :: fault
      real(dp) :: jacobian, x, stretch, width, limit, gap, chi_l, chi_f, norm, dx(3, 3), kappa, a, j2, floor, slope_x, counted(3, 3)
      a = props(p_a)
      s = 0; g = 0; slopes = 0; scalars = 0
      c = matmul(transpose(f1), f1)
      c_rate = matmul(transpose(f1 - f0), f1 + f0)/dt
      c_rate = 0.5_dp*(c_rate + transpose(c_rate))
      jacobian = determinant_3(f1)
      fault = .not. jacobian > 0
      if (fault) return
      c_inverse = inverse_symmetric(c)
      ! Squared stretch x of the thickness along the ply normal, axis 3, and its gradient (sec. 4.4).
      x = 1/c_inverse(3, 3)
      dx = x**2*spread(c_inverse(:, 3), 2, 3)*spread(c_inverse(:, 3), 1, 3)
      stretch = sqrt(x)
      width = jacobian/(stretch*sqrt(c(1, 1)))
      norm = sum(c(2:3, 2:3)**2)
      counted = c_rate
      counted(1:2, 1:2) = in_plane*counted(1:2, 1:2)
      j2 = 0.5_dp*sum(counted**2)
      floor = max(props(p_rate_floor), props(p_strain_floor)/dt)**2
      ! Viscous factor g = (a+2) f J2**(a/2), Eqs. 13 to 15.
      chi_l = exp(-2*props(p_eps_lock)); chi_f = chi_l/props(p_chi_ratio)
      limit = props(p_k)/sqrt(chi_f)
      gap = stretch - limit
      fault = .not. gap > 0
      if (fault) return
      if (locked) then
         kappa = 0
         g = (props(p_l0_over_d)*props(p_w0)/props(p_h0))**2*chi_l/chi_f*4*jacobian*props(p_k)*(props(p_k)/gap)**2/x &
             /(2*x**2)*exp(props(p_b_bleed))*((j2 + floor)/(2*x**2))**(0.5_dp*a)
         slope_x = -1/x - 1/(gap*stretch) - (a + 2)/x
         slopes = 2*slope_x*dx
      else
         kappa = props(p_kappa)
         g = (props(p_w0)/props(p_h0))**2*sqrt(chi_l)/chi_f*4*jacobian*props(p_k)*((props(p_k)/gap)**2 + 3*chi_f) &
             /(x*stretch)/(2*norm)*exp(props(p_b_squeeze))*((j2 + floor)/(2*norm))**(0.5_dp*a)
         slope_x = -1.5_dp/x - (props(p_k)/gap)**2/((props(p_k)/gap)**2 + 3*chi_f)/(gap*stretch)
         slopes = 2*slope_x*dx
         slopes(2:3, 2:3) = slopes(2:3, 2:3) - 2*(a + 2)*c(2:3, 2:3)/norm
      end if
      slopes = slopes + c_inverse + a*counted/((j2 + floor)*dt)
      s = elastic_stress(c, c_inverse, jacobian, kappa, props) + g*c_rate
      scalars = [jacobian, stretch, width, 0.5_dp*sum(dx*c_rate)/x, kappa, j2, floor, norm]
   end subroutine law_stress

   !! Constants mu_T, mu_L, lambda, alpha, beta of Eq. 10 from the compliance, MPa.
   function elastic_constants(props) result(moduli)
      real(dp), intent(in) :: props(n_props)
      real(dp) :: moduli(5), along, cross, inner, scale
      associate (e_l => props(p_e_l), e_t => props(p_e_t), nu_lt => props(p_nu_lt), nu_tt => props(p_nu_tt))
         scale = 1/(1 - nu_tt - 2*nu_lt**2*e_t/e_l)
         along = e_l*(1 - nu_tt)*scale
         cross = e_t*nu_lt*scale
         inner = e_t*(nu_tt + nu_lt**2*e_t/e_l)*scale/(1 + nu_tt)
         moduli(1:4) = [e_t/(2*(1 + nu_tt)), props(p_g_lt), inner, cross - inner]
         moduli(5) = along - inner - 2*moduli(4) - 4*moduli(2) + 2*moduli(1)
      end associate
   end function elastic_constants

   !! S = 2 d psi_e/dC + kappa (J - 1) J C**-1.
   function elastic_stress(c, c_inverse, jacobian, kappa, props) result(s)
      real(dp), intent(in) :: c(3, 3), c_inverse(3, 3), jacobian, kappa, props(n_props)
      real(dp) :: s(3, 3), m(5), slope, i4
      integer :: i
      m = elastic_constants(props)
      i4 = c(1, 1)
      slope = -m(1)/jacobian + (m(3) + kappa)*(jacobian - 1) + 0.5_dp*m(4)*(i4 - 1)/jacobian
      s = jacobian*slope*c_inverse
      do i = 1, 3
         s(i, i) = s(i, i) + m(1)
      end do
      s(1, 1) = s(1, 1) + 2*((m(1) - m(2)) + 0.5_dp*m(4)*log(jacobian) + 0.25_dp*m(5)*(i4 - 1))
      s(1, :) = s(1, :) - (m(1) - m(2))*c(1, :)
      s(:, 1) = s(:, 1) - (m(1) - m(2))*c(:, 1)
   end function elastic_stress

   !! Whether the increment ends past the lock (Eq. 6). The one that passes it counts the rate in the ply plane from the width
   !! at the lock: `from` is the deformation gradient at its start, widened across the fibre.
   subroutine flow_stage(f0, f1, props, statev, locked, from)
      real(dp), intent(in) :: f0(3, 3), f1(3, 3), props(n_props), statev(n_statev)
      logical, intent(out) :: locked
      real(dp), intent(out) :: from(3, 3)
      real(dp) :: x_lock
      x_lock = exp(2*props(p_eps_lock))
      locked = statev(s_locked) >= 0.5_dp
      from = f0
      if (squared_stretch(f1) > x_lock) return
      if (.not. locked .and. squared_stretch(f0) > x_lock) from(:, 2) = f0(:, 2)*sqrt(squared_stretch(f0)/x_lock)
      locked = .true.
   end subroutine flow_stage

   pure real(dp) function squared_stretch(f)
      real(dp), intent(in) :: f(3, 3)
      real(dp) :: c_inverse(3, 3)
      c_inverse = inverse_symmetric(matmul(transpose(f), f))
      squared_stretch = 1/c_inverse(3, 3)
   end function squared_stretch

   !! State and dissipation at the end.
   subroutine finish(scalars, g, dt, locked, statev, scd)
      real(dp), intent(in) :: scalars(8), g, dt
      logical, intent(in) :: locked
      real(dp), intent(inout) :: statev(n_statev), scd
      associate (jacobian => scalars(1), j2 => scalars(6))
         statev(s_eps) = log(scalars(2))
         statev(s_width) = scalars(3)
         statev(s_j) = jacobian
         statev(s_fibre_fraction) = 0.5_dp/jacobian
         statev(s_locked) = merge(1.0_dp, 0.0_dp, locked)
         statev(s_pressure) = -scalars(5)*(jacobian - 1)
         statev(s_eps_rate) = scalars(4)
         statev(s_dissipation) = statev(s_dissipation) + dt*g*j2
         scd = scd + dt*g*j2
      end associate
   end subroutine finish

   !! At vanishing rate: how many times the tangent's viscosity exceeds that of the floor, from the last converged rate.
   pure real(dp) function idle_factor(scalars, a, locked, last_rate)
      real(dp), intent(in) :: scalars(8), a, last_rate
      logical, intent(in) :: locked
      real(dp) :: j2_last
      idle_factor = 1
      if (scalars(6) > scalars(7)) return
      j2_last = 2*scalars(8)*last_rate**2
      if (locked) j2_last = 2*scalars(2)**4*last_rate**2
      if (j2_last > scalars(6) + scalars(7)) idle_factor = (j2_last/(scalars(6) + scalars(7)))**(0.5_dp*a)
   end function idle_factor

   pure real(dp) function determinant_3(a)
      real(dp), intent(in) :: a(3, 3)
      determinant_3 = a(1, 1)*(a(2, 2)*a(3, 3) - a(2, 3)*a(3, 2)) - a(1, 2)*(a(2, 1)*a(3, 3) - a(2, 3)*a(3, 1)) &
                      + a(1, 3)*(a(2, 1)*a(3, 2) - a(2, 2)*a(3, 1))
   end function determinant_3

   pure function inverse_symmetric(a) result(b)
      real(dp), intent(in) :: a(3, 3)
      real(dp) :: b(3, 3)
      b(:, 1) = [a(2, 2)*a(3, 3) - a(2, 3)**2, a(1, 3)*a(2, 3) - a(1, 2)*a(3, 3), a(1, 2)*a(2, 3) - a(1, 3)*a(2, 2)]
      b(2:3, 2) = [a(1, 1)*a(3, 3) - a(1, 3)**2, a(1, 2)*a(1, 3) - a(1, 1)*a(2, 3)]
      b(3, 3) = a(1, 1)*a(2, 2) - a(1, 2)**2
      b(1, 2:3) = b(2:3, 1); b(2, 3) = b(3, 2)
      b = b/(a(1, 1)*b(1, 1) + a(1, 2)*b(1, 2) + a(1, 3)*b(1, 3))
   end function inverse_symmetric
end module peer_law
