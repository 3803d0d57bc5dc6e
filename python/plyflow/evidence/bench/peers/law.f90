!! The law written out by hand in 3 by 3 matrices: what a careful engineer would code from the paper. Shared by the peers,
!! which differ in how they come by DDSDDE. PROPS and STATEV are those of the default scene; fibre along axis 1.
module peer_law
   use peer_places
   implicit none
   integer, parameter :: dp = kind(1.0d0)
contains

   !! Second Piola-Kirchhoff stress, coefficients and bookkeeping of one increment.
   subroutine law_stress(f0, f1, dt, props, locked, c, c_inverse, c_rate, g, slopes, scalars, s, fault)
      real(dp), intent(in) :: f0(3, 3), f1(3, 3), dt, props(n_props)
      logical, intent(in) :: locked                           !! bleeding
      real(dp), intent(out) :: c(3, 3), c_inverse(3, 3)       !! right Cauchy-Green tensor
      real(dp), intent(out) :: c_rate(3, 3)                   !! (C1 - C0)/dt, 1/s
      real(dp), intent(out) :: g                              !! S_v = g Cdot, MPa s
      real(dp), intent(out) :: slopes(3, 3)                   !! 2 d ln g/dC
      real(dp), intent(out) :: scalars(8)                     !! J, stretch, width, rate, kappa, J2, floor of J2, A:A
      real(dp), intent(out) :: s(3, 3)                        !! MPa
      logical, intent(out) :: fault
      real(dp) :: jacobian, area, mean, difference, radius, x, stretch, limit, gap, chi_l, chi_f, norm, dx(3, 3), kappa
      real(dp) :: cosine, sine, a, j2, floor, slope_x
      a = props(p_a)
      s = 0; g = 0; slopes = 0; scalars = 0
      c = matmul(transpose(f1), f1)
      c_rate = matmul(transpose(f1 - f0), f1 + f0)/dt
      c_rate = 0.5_dp*(c_rate + transpose(c_rate))
      jacobian = determinant_3(f1)
      fault = .not. jacobian > 0
      if (fault) return
      c_inverse = inverse_symmetric(c)
      ! Smallest eigenvalue x of the transverse block and its gradient; the mean where both stretches are the same.
      area = jacobian**2*c_inverse(1, 1)
      mean = 0.5_dp*(c(2, 2) + c(3, 3))
      difference = 0.5_dp*sum((f1(:, 2) - f1(:, 3))*(f1(:, 2) + f1(:, 3)))
      radius = sqrt(difference**2 + c(2, 3)**2)
      x = area/(mean + radius)
      cosine = difference/max(radius, 2.0e-14_dp*mean)
      sine = c(2, 3)/max(radius, 2.0e-14_dp*mean)
      dx = 0
      dx(2, 2) = 0.5_dp*(1 - cosine); dx(3, 3) = 0.5_dp*(1 + cosine)
      dx(2, 3) = -0.5_dp*sine; dx(3, 2) = dx(2, 3)
      stretch = sqrt(x)
      norm = sum(c(2:3, 2:3)**2)
      j2 = 0.5_dp*sum(c_rate**2)
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
      slopes = slopes + c_inverse + a*c_rate/((j2 + floor)*dt)
      s = elastic_stress(c, c_inverse, jacobian, kappa, props) + g*c_rate
      scalars = [jacobian, stretch, sqrt(area)/stretch, 0.5_dp*sum(dx*c_rate)/x, kappa, j2, floor, norm]
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

   !! Whether the increment starts past the lock (Eq. 6), and the stretch there.
   subroutine flow_stage(f0, props, statev, locked, x_start, lock_stretch)
      real(dp), intent(in) :: f0(3, 3), props(n_props), statev(n_statev)
      logical, intent(out) :: locked
      real(dp), intent(out) :: x_start, lock_stretch
      real(dp) :: c(3, 3)
      c = matmul(transpose(f0), f0)
      x_start = (c(2, 2)*c(3, 3) - c(2, 3)**2)/(0.5_dp*(c(2, 2) + c(3, 3)) &
                                                + sqrt(0.25_dp*(c(2, 2) - c(3, 3))**2 + c(2, 3)**2))
      lock_stretch = exp(props(p_eps_lock))
      locked = statev(s_locked) >= 0.5_dp .or. x_start <= (lock_stretch*(1 + 1.0e-5_dp))**2
   end subroutine flow_stage

   !! State, energies and PNEWDT at the end; an increment that oversteps the lock is asked to end on it.
   subroutine finish(scalars, g, dt, props, locked, x_start, lock_stretch, statev, scd, pnewdt)
      real(dp), intent(in) :: scalars(8), g, dt, props(n_props), x_start, lock_stretch
      logical, intent(in) :: locked
      real(dp), intent(inout) :: statev(n_statev), scd, pnewdt
      real(dp) :: limit, chord, creep
      associate (jacobian => scalars(1), stretch => scalars(2), rate => scalars(4), j2 => scalars(6))
         if (.not. locked .and. stretch < lock_stretch*(1 - 1.0e-5_dp)) then
            limit = props(p_k)*exp(props(p_eps_lock))*sqrt(props(p_chi_ratio))
            chord = log(x_start/lock_stretch**2)/log(x_start/stretch**2)
            creep = 0.5_dp*log(x_start/lock_stretch**2)/(abs(rate)*dt &
                    *(viscosity(stretch, limit)/viscosity(lock_stretch, limit))**(1/(props(p_a) + 1)))
            pnewdt = min(pnewdt, sqrt(chord*min(chord, max(1.0e-3_dp, creep))))
         end if
         statev(s_eps) = log(stretch)
         statev(s_width) = scalars(3)
         statev(s_j) = jacobian
         statev(s_fibre_fraction) = 0.5_dp/jacobian
         statev(s_locked) = merge(1.0_dp, 0.0_dp, locked .or. stretch <= lock_stretch*(1 + 1.0e-5_dp))
         statev(s_pressure) = -scalars(5)*(jacobian - 1)
         statev(s_eps_rate) = rate
         statev(s_dissipation) = statev(s_dissipation) + dt*g*j2
         scd = scd + dt*g*j2
      end associate
   end subroutine finish

   !! Squeezing viscosity over its constant factor, Eqs. 2 and 4.
   pure real(dp) function viscosity(stretch, limit)
      real(dp), intent(in) :: stretch, limit
      viscosity = (limit**2/(stretch - limit)**2 + 3)/stretch**3
   end function viscosity

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
