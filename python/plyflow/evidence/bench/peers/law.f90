!! The law written out by hand in 3 by 3 matrices: what a careful engineer would code from the paper. Shared by the peers,
!! which differ in how they come by DDSDDE. PROPS and STATEV are those of the default scene; fibre along axis 1.

!! Second Piola-Kirchhoff stress, coefficients and bookkeeping of one increment.
subroutine law_stress(f0, f1, dt, props, locked, c, c_inverse, c_rate, g, slopes, scalars, s, fault)
   implicit none
   integer, parameter :: dp = kind(1.0d0)
   real(dp), intent(in) :: f0(3, 3), f1(3, 3), dt, props(17)
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
   real(dp), external :: determinant_3
   a = props(5)
   s = 0; g = 0; slopes = 0; scalars = 0
   c = matmul(transpose(f1), f1)
   c_rate = matmul(transpose(f1 - f0), f1 + f0)/dt
   c_rate = 0.5_dp*(c_rate + transpose(c_rate))
   jacobian = determinant_3(f1)
   fault = .not. jacobian > 0
   if (fault) return
   call inverse_symmetric(c, c_inverse)
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
   floor = max(props(16), props(17)/dt)**2
   ! Viscous factor g = (a+2) f J2**(a/2), Eqs. 13 to 15.
   chi_l = exp(-2*props(8)); chi_f = chi_l/props(9)
   limit = props(4)/sqrt(chi_f)
   gap = stretch - limit
   fault = .not. gap > 0
   if (fault) return
   if (locked) then
      kappa = 0
      g = (props(3)*props(1)/props(2))**2*chi_l/chi_f*4*jacobian*props(4)*(props(4)/gap)**2/x/(2*x**2) &
          *exp(props(7))*((j2 + floor)/(2*x**2))**(0.5_dp*a)
      slope_x = -1/x - 1/(gap*stretch) - (a + 2)/x
      slopes = 2*slope_x*dx
   else
      kappa = props(15)
      g = (props(1)/props(2))**2*sqrt(chi_l)/chi_f*4*jacobian*props(4)*((props(4)/gap)**2 + 3*chi_f)/(x*stretch) &
          /(2*norm)*exp(props(6))*((j2 + floor)/(2*norm))**(0.5_dp*a)
      slope_x = -1.5_dp/x - (props(4)/gap)**2/((props(4)/gap)**2 + 3*chi_f)/(gap*stretch)
      slopes = 2*slope_x*dx
      slopes(2:3, 2:3) = slopes(2:3, 2:3) - 2*(a + 2)*c(2:3, 2:3)/norm
   end if
   slopes = slopes + c_inverse + a*c_rate/((j2 + floor)*dt)
   call elastic_stress(c, c_inverse, jacobian, kappa, props, s)
   s = s + g*c_rate
   scalars = [jacobian, stretch, sqrt(area)/stretch, 0.5_dp*sum(dx*c_rate)/x, kappa, j2, floor, norm]
end subroutine law_stress

!! Constants mu_T, mu_L, lambda, alpha, beta of Eq. 10 from the compliance, MPa.
subroutine elastic_constants(props, moduli)
   implicit none
   integer, parameter :: dp = kind(1.0d0)
   real(dp), intent(in) :: props(17)
   real(dp), intent(out) :: moduli(5)
   real(dp) :: along, across, cross, inner, scale
   associate (e_l => props(10), e_t => props(11), nu_lt => props(12), nu_tt => props(13), g_lt => props(14))
      scale = 1/(1 - nu_tt - 2*nu_lt**2*e_t/e_l)
      along = e_l*(1 - nu_tt)*scale
      cross = e_t*nu_lt*scale
      inner = e_t*(nu_tt + nu_lt**2*e_t/e_l)*scale/(1 + nu_tt)
      across = e_t/(2*(1 + nu_tt))
      moduli(1) = across
      moduli(2) = g_lt
      moduli(3) = inner
      moduli(4) = cross - inner
      moduli(5) = along - inner - 2*moduli(4) - 4*g_lt + 2*across
   end associate
end subroutine elastic_constants

!! S = 2 d psi_e/dC + kappa (J - 1) J C**-1.
subroutine elastic_stress(c, c_inverse, jacobian, kappa, props, s)
   implicit none
   integer, parameter :: dp = kind(1.0d0)
   real(dp), intent(in) :: c(3, 3), c_inverse(3, 3), jacobian, kappa, props(17)
   real(dp), intent(out) :: s(3, 3)
   real(dp) :: m(5), slope, i4
   integer :: i
   call elastic_constants(props, m)
   i4 = c(1, 1)
   slope = -m(1)/jacobian + (m(3) + kappa)*(jacobian - 1) + 0.5_dp*m(4)*(i4 - 1)/jacobian
   s = jacobian*slope*c_inverse
   do i = 1, 3
      s(i, i) = s(i, i) + m(1)
   end do
   s(1, 1) = s(1, 1) + 2*((m(1) - m(2)) + 0.5_dp*m(4)*log(jacobian) + 0.25_dp*m(5)*(i4 - 1))
   s(1, :) = s(1, :) - (m(1) - m(2))*c(1, :)
   s(:, 1) = s(:, 1) - (m(1) - m(2))*c(:, 1)
end subroutine elastic_stress

!! Whether the increment starts past the lock (Eq. 6), and the stretch there.
subroutine flow_stage(f0, props, statev, locked, x_start, lock_stretch)
   implicit none
   integer, parameter :: dp = kind(1.0d0)
   real(dp), intent(in) :: f0(3, 3), props(17), statev(8)
   logical, intent(out) :: locked
   real(dp), intent(out) :: x_start, lock_stretch
   real(dp) :: c(3, 3)
   c = matmul(transpose(f0), f0)
   x_start = (c(2, 2)*c(3, 3) - c(2, 3)**2)/(0.5_dp*(c(2, 2) + c(3, 3)) &
                                             + sqrt(0.25_dp*(c(2, 2) - c(3, 3))**2 + c(2, 3)**2))
   lock_stretch = exp(props(8))
   locked = statev(5) >= 0.5_dp .or. x_start <= (lock_stretch*(1 + 1.0e-5_dp))**2
end subroutine flow_stage

!! State, energies and PNEWDT at the end; an increment that oversteps the lock is asked to end on it.
subroutine finish(scalars, g, dt, props, locked, x_start, lock_stretch, statev, scd, pnewdt)
   implicit none
   integer, parameter :: dp = kind(1.0d0)
   real(dp), intent(in) :: scalars(8), g, dt, props(17), x_start, lock_stretch
   logical, intent(in) :: locked
   real(dp), intent(inout) :: statev(8), scd, pnewdt
   real(dp) :: limit, chord, creep
   associate (stretch => scalars(2), rate => scalars(4), j2 => scalars(6))
      if (.not. locked .and. stretch < lock_stretch*(1 - 1.0e-5_dp)) then
         limit = props(4)*exp(props(8))*sqrt(props(9))
         chord = log(x_start/lock_stretch**2)/log(x_start/stretch**2)
         creep = 0.5_dp*log(x_start/lock_stretch**2)/(abs(rate)*dt &
                 *(viscosity(stretch)/viscosity(lock_stretch))**(1/(props(5) + 1)))
         pnewdt = min(pnewdt, sqrt(chord*min(chord, max(1.0e-3_dp, creep))))
      end if
      statev = [log(stretch), scalars(3), scalars(1), 0.5_dp/scalars(1), &
                merge(1.0_dp, 0.0_dp, locked .or. stretch <= lock_stretch*(1 + 1.0e-5_dp)), &
                -scalars(5)*(scalars(1) - 1), rate, statev(8) + dt*g*j2]
      scd = scd + dt*g*j2
   end associate
contains
   !! Squeezing viscosity over its constant factor, Eqs. 2 and 4.
   pure real(dp) function viscosity(stretch)
      real(dp), intent(in) :: stretch
      viscosity = (limit**2/(stretch - limit)**2 + 3)/stretch**3
   end function viscosity
end subroutine finish

!! At vanishing rate: how many times the tangent's viscosity exceeds that of the floor, from the last converged rate.
subroutine idle_factor(scalars, a, locked, last_rate, factor)
   implicit none
   integer, parameter :: dp = kind(1.0d0)
   real(dp), intent(in) :: scalars(8), a, last_rate
   logical, intent(in) :: locked
   real(dp), intent(out) :: factor
   real(dp) :: j2_last
   factor = 1
   if (scalars(6) > scalars(7)) return
   j2_last = 2*scalars(8)*last_rate**2
   if (locked) j2_last = 2*scalars(2)**4*last_rate**2
   if (j2_last > scalars(6) + scalars(7)) factor = (j2_last/(scalars(6) + scalars(7)))**(0.5_dp*a)
end subroutine idle_factor

!! F S F**T.
subroutine push_forward(f, s, tau)
   implicit none
   integer, parameter :: dp = kind(1.0d0)
   real(dp), intent(in) :: f(3, 3), s(3, 3)
   real(dp), intent(out) :: tau(3, 3)
   tau = matmul(matmul(f, s), transpose(f))
end subroutine push_forward

function determinant_3(a) result(value)
   implicit none
   integer, parameter :: dp = kind(1.0d0)
   real(dp), intent(in) :: a(3, 3)
   real(dp) :: value
   value = a(1, 1)*(a(2, 2)*a(3, 3) - a(2, 3)*a(3, 2)) - a(1, 2)*(a(2, 1)*a(3, 3) - a(2, 3)*a(3, 1)) &
           + a(1, 3)*(a(2, 1)*a(3, 2) - a(2, 2)*a(3, 1))
end function determinant_3

subroutine inverse_symmetric(a, b)
   implicit none
   integer, parameter :: dp = kind(1.0d0)
   real(dp), intent(in) :: a(3, 3)
   real(dp), intent(out) :: b(3, 3)
   b(1, 1) = a(2, 2)*a(3, 3) - a(2, 3)**2
   b(2, 2) = a(1, 1)*a(3, 3) - a(1, 3)**2
   b(3, 3) = a(1, 1)*a(2, 2) - a(1, 2)**2
   b(1, 2) = a(1, 3)*a(2, 3) - a(1, 2)*a(3, 3)
   b(1, 3) = a(1, 2)*a(2, 3) - a(1, 3)*a(2, 2)
   b(2, 3) = a(1, 2)*a(1, 3) - a(1, 1)*a(2, 3)
   b(2, 1) = b(1, 2); b(3, 1) = b(1, 3); b(3, 2) = b(2, 3)
   b = b/(a(1, 1)*b(1, 1) + a(1, 2)*b(1, 2) + a(1, 3)*b(1, 3))
end subroutine inverse_symmetric
