!! A case file that repeats the one increment an analysis failed in.
module driver_replay
   use driver_kinds, only: dp, outcome_max_iterations, outcome_diverged, outcome_singular, outcome_text
   use driver_case, only: material_point_case, point_state, temperature_at, with_temperatures
   use driver_case_keys, only: component_name, write_controls
   use driver_tensors, only: voigt_row, voigt_col
   use driver_history, only: history_record, failed_increment
   use driver_text, only: open_new
   implicit none
   private
   public :: write_replay
   character(len=*), parameter :: matrix_line = '(2x,a,9es25.16e3)', vector_line = '(2x,a,6es25.16e3)'
contains
   !! Where the iterations failed they are repeated from the same guess; where the UMAT failed, the call is.
   subroutine write_replay(path, library, symbol, problem, history, message)
      character(len=*), intent(in) :: path, library, symbol
      type(material_point_case), intent(in) :: problem
      type(history_record), intent(in) :: history
      character(len=:), allocatable, intent(inout) :: message
      logical :: iterate
      integer :: unit
      call open_new(path, unit, message)
      if (len(message) > 0) return
      associate (failure => history%failure)
         iterate = any(failure%outcome == [outcome_max_iterations, outcome_diverged, outcome_singular])
         write (unit, '(2a)') '! Repeats the increment that failed: ', outcome_text(failure%outcome)
         call write_material(unit, library, symbol, problem, history%last%total_time)
         call write_controls(unit, problem%controls, failure%dt, failure%load_scale)
         call write_start(unit, history%last, failure, iterate)
         call write_step(unit, failure, iterate, temperature_at(with_temperatures(problem), history%last%total_time + failure%dt))
      end associate
      close (unit)
   end subroutine write_replay

   subroutine write_material(unit, library, symbol, problem, time)
      integer, intent(in) :: unit
      character(len=*), intent(in) :: library, symbol
      type(material_point_case), intent(in) :: problem
      real(dp), intent(in) :: time                         !! s, total, at the start of the increment
      write (unit, '(2a)') 'library = ', library, 'symbol = ', symbol, 'material = ', trim(problem%material%name), &
         'replay = ', 'none'
      write (unit, '(a,i0)') 'n_statev = ', problem%material%n_statev, 'ntens = ', problem%material%ntens
      if (problem%material%corotated) write (unit, '(a)') 'corotated = yes'
      write (unit, '(a,es24.16e3)') 'temperature =', temperature_at(with_temperatures(problem), time)
      if (size(problem%material%props) > 0) write (unit, '("props =",4es25.16e3)') problem%material%props
   end subroutine write_material

   subroutine write_start(unit, last, failure, iterate)
      integer, intent(in) :: unit
      type(point_state), intent(in) :: last
      type(failed_increment), intent(in) :: failure
      logical, intent(in) :: iterate
      write (unit, '(a)') 'begin start'
      write (unit, matrix_line) 'deformation_gradient =', transpose(last%f)
      if (iterate) write (unit, matrix_line) 'first_guess =', transpose(failure%f_guess)
      write (unit, vector_line) 'stress =', last%stress
      write (unit, vector_line) 'strain =', last%stran
      write (unit, vector_line) 'energies =', last%energy
      write (unit, vector_line) 'pressure =', last%pressure
      if (size(last%statev) > 0) write (unit, '("  statev =",4es25.16e3)') last%statev
      write (unit, vector_line) 'step_time =', last%step_time
      write (unit, vector_line) 'total_time =', last%total_time
      write (unit, '(2x,a,i0)') 'step = ', last%step, 'increment = ', last%increment
      write (unit, '(a)') 'end start'
   end subroutine write_start

   subroutine write_step(unit, failure, iterate, temperature)
      integer, intent(in) :: unit
      type(failed_increment), intent(in) :: failure
      logical, intent(in) :: iterate
      real(dp), intent(in) :: temperature                  !! degC, at the end of the increment
      character(len=*), parameter :: target_line = '(2x,3a,es25.16e3)'
      integer :: i
      write (unit, '(a)') 'begin step'
      write (unit, '(2x,a,es25.16e3)') 'duration =', failure%dt
      write (unit, '(2x,a)') 'instant = yes'
      write (unit, '(2x,a,es25.16e3)') 'temperature =', temperature
      do i = 1, 6
         if (iterate .and. failure%stress_controlled(i)) then
            write (unit, target_line) 'S', component_name(i), ' =', failure%stress_target(i)
         else
            write (unit, target_line) 'F', component_name(i), ' =', failure%f_end(voigt_row(i), voigt_col(i))
         end if
      end do
      write (unit, target_line) ('F', component_name(i), ' =', failure%f_end(voigt_row(i), voigt_col(i)), i=7, 9)
      write (unit, '(a)') 'end step'
   end subroutine write_step
end module driver_replay
