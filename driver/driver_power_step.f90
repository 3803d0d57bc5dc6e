!! A Newton step for stress that grows like (strain increment)**n, n between 0 and 1.
module driver_power_step
   use driver_kinds, only: dp
   implicit none
   private
   public :: power_step
   real(dp), parameter :: smallest_exponent = 0.02_dp, largest_factor = 1.0e6_dp
contains
   !! Plain Newton on s ~ w**n overshoots by 1/n from above. Along w the power law is inverted exactly instead:
   !! phi = (1 + n rho)**(1/n) = 1 + rho + O(rho**2), so the order of convergence stays two.
   pure function power_step(increment, correction, stress_preimage, fraction) result(step)
      real(dp), intent(in) :: increment(:)                 !! w: unknowns, zero at the start of the increment
      real(dp), intent(in) :: correction(:)                !! du: Newton's correction
      real(dp), intent(in) :: stress_preimage(:)           !! z: K z = current stress; w/n for a power law
      real(dp), intent(in) :: fraction                     !! 1, or less to step back
      real(dp) :: step(size(increment))
      real(dp) :: rho, exponent, length_squared, inverse_exponent, growth
      step = fraction**2*correction
      length_squared = dot_product(increment, increment)
      if (.not. length_squared > tiny(1.0_dp)) return
      rho = dot_product(increment, correction)/length_squared
      inverse_exponent = dot_product(increment, stress_preimage)/length_squared
      if (.not. inverse_exponent > 0.0_dp) return
      exponent = min(1.0_dp, max(smallest_exponent, 1.0_dp/inverse_exponent))
      if (.not. 1.0_dp + exponent*rho > 0.0_dp) return
      growth = growth_less_one(exponent, rho)
      if (rho > 0.0_dp) then
         step = beyond_newton(increment, correction, rho, growth, fraction)
      else
         step = increment*growth_fraction(growth, fraction) + fraction**2*(correction - rho*increment)
      end if
   end function power_step

   !! Growth scales the point that Newton aims at, not w: where a stiff constraint turns the direction between the
   !! two, w would run far off it. It goes beyond Newton's point only as far as du and w agree in direction.
   pure function beyond_newton(increment, correction, rho, growth, fraction) result(step)
      real(dp), intent(in) :: increment(:), correction(:), rho, growth, fraction
      real(dp) :: step(size(increment)), across, excess
      across = norm2(correction - rho*increment)/(rho*norm2(increment))
      excess = min((growth - rho)/(1.0_dp + rho), 1.0_dp/max(across, tiny(1.0_dp)))
      if (fraction < 1.0_dp) then
         step = increment*growth_fraction(rho + excess*(1.0_dp + rho), fraction) &
                + fraction**2*(correction - rho*increment)
      else
         step = correction + excess*(increment + correction)
      end if
   end function beyond_newton

   !! The power `fraction` of a growth factor, both less one.
   pure real(dp) function growth_fraction(growth, fraction)
      real(dp), intent(in) :: growth, fraction
      growth_fraction = growth
      if (fraction < 1.0_dp) growth_fraction = (1.0_dp + growth)**fraction - 1.0_dp
   end function growth_fraction

   !! phi - 1 without cancellation for small rho.
   pure real(dp) function growth_less_one(exponent, rho)
      real(dp), intent(in) :: exponent, rho
      real(dp) :: logarithm
      if (abs(rho) < 1.0e-4_dp) then
         growth_less_one = rho*(1.0_dp + 0.5_dp*(1.0_dp - exponent)*rho)
      else
         logarithm = log(1.0_dp + exponent*rho)/exponent
         growth_less_one = exp(max(-log(largest_factor), min(log(largest_factor), logarithm))) - 1.0_dp
      end if
   end function growth_less_one
end module driver_power_step
