!! DDSDDE against central differences of the Kirchhoff stress, along the path of an analysis.
module driver_tangent_check
   use driver_kinds, only: dp, outcome_converged
   use driver_tensors, only: determinant, identity, strain_matrix
   use driver_case, only: point_state
   use driver_material, only: material_point, point_response, evaluate
   use driver_history, only: history_record
   implicit none
   private
   public :: check_tangent, numerical_tangent
   integer, parameter :: n_steps = 5
   real(dp), parameter :: smallest_step = 1.0e-12_dp        !! of strain: well above the rounding of F
   real(dp), parameter :: agreement = 1.0e-3_dp             !! of differences with neighbouring steps
contains
   !! Keep the largest difference relative to the largest numerical entry. Differences with several steps are
   !! tried: only those count that agree with those of the next step (else it is rounding or the curvature of a
   !! nearly rate-independent stress that they show), and of these the one nearest to DDSDDE.
   subroutine check_tangent(point, start, converged, dt, history)
      type(material_point), intent(inout) :: point
      type(point_state), intent(in) :: start
      type(point_response), intent(in) :: converged        !! at the end of the accepted increment
      real(dp), intent(in) :: dt                           !! s
      type(history_record), intent(inout) :: history
      real(dp) :: numerical(6, 6, n_steps), steps(n_steps), difference, smallest
      logical :: usable(n_steps)
      integer :: i, best, n
      n = point%settings%ntens
      steps(1:3) = maxval(abs(converged%dstran))*[1.0e-2_dp, 1.0e-3_dp, 1.0e-4_dp]
      steps(4:5) = [1.0e-6_dp, 1.0e-7_dp]
      do i = 1, n_steps
         call numerical_tangent(point, start, converged%f, dt, max(smallest_step, steps(i)), numerical(:, :, i), &
                                usable(i))
         usable(i) = usable(i) .and. steps(i) >= smallest_step
      end do
      smallest = huge(1.0_dp)
      best = 1
      do i = 1, n_steps - 1
         if (.not. (usable(i) .and. usable(i + 1)) .or. i == 3) cycle
         if (relative_difference(numerical(:n, :n, i + 1), numerical(:n, :n, i)) > agreement) cycle
         difference = relative_difference(converged%ddsdde(:n, :n), numerical(:n, :n, i))
         if (difference < smallest) best = i
         smallest = min(smallest, difference)
      end do
      if (.not. smallest < huge(1.0_dp) .or. smallest <= history%worst_tangent(1)) return
      history%worst_tangent = [real(dp) :: smallest, history%n_states, &
                               maxloc(abs(numerical(:n, :n, best) - converged%ddsdde(:n, :n)))]
      history%tangent_pair(:, :, 1) = converged%ddsdde
      history%tangent_pair(:, :, 2) = numerical(:, :, best)
   end subroutine check_tangent

   pure real(dp) function relative_difference(a, b)
      real(dp), intent(in) :: a(:, :), b(:, :)
      relative_difference = maxval(abs(a - b))/max(maxval(abs(b)), tiny(1.0_dp))
   end function relative_difference

   !! (1/J) d tau / d eps for the six stretching perturbations of the end of the increment.
   subroutine numerical_tangent(point, start, f_end, dt, step, tangent, usable)
      type(material_point), intent(inout) :: point
      type(point_state), intent(in) :: start
      real(dp), intent(in) :: f_end(3, 3), dt
      real(dp), intent(in) :: step                         !! strain
      real(dp), intent(out) :: tangent(6, 6)               !! MPa
      logical, intent(out) :: usable                       !! every perturbed call succeeded
      type(point_response) :: side
      real(dp) :: strain(6), f(3, 3), kirchhoff(6, 2)
      integer :: j, k
      usable = .true.
      tangent = 0.0_dp
      do j = 1, point%settings%ntens
         do k = 1, 2
            strain = 0.0_dp
            strain(j) = merge(step, -step, k == 1)
            f = matmul(identity + strain_matrix(strain), f_end)
            call evaluate(point, start, f, dt, side)
            usable = usable .and. side%outcome == outcome_converged
            kirchhoff(:, k) = determinant(f)*side%stress
         end do
         tangent(:, j) = (kirchhoff(:, 1) - kirchhoff(:, 2))/(2.0_dp*step*determinant(f_end))
      end do
   end subroutine numerical_tangent
end module driver_tangent_check
