!! Files of an analysis: the history as CSV and the increment table as Abaqus's .sta.
module driver_output
   use driver_kinds, only: dp, outcome_converged, outcome_rounding, outcome_text
   use driver_history, only: history_record, n_fixed
   use driver_text, only: open_new
   implicit none
   private
   public :: write_history, write_increments
   character(len=*), parameter :: fixed_columns = 'total_time,step_time,step,increment,increment_size,iterations,'// &
      'F11,F12,F13,F21,F22,F23,F31,F32,F33,S11,S22,S33,S12,S13,S23,pressure,'// &
      'E11,E22,E33,E12,E13,E23,SSE,SPD,SCD,work,work_right'
contains
   !! One row per accepted state, the start first; reals with all their digits.
   subroutine write_history(path, history, message)
      character(len=*), intent(in) :: path
      type(history_record), intent(in) :: history
      character(len=:), allocatable, intent(inout) :: message
      integer :: unit, i
      call open_new(path, unit, message)
      if (len(message) > 0) return
      write (unit, '(a)', advance='no') fixed_columns
      do i = 1, size(history%states, 1) - n_fixed
         write (unit, '(a,i0)', advance='no') ',SDV', i
      end do
      write (unit, '()')
      do i = 1, history%n_states
         associate (row => history%states(:, i))
            write (unit, '(2(es24.16e3,","),2(i0,","),es24.16e3,",",i0,*(:,",",es24.16e3))') row(1:2), &
               nint(row(3:4)), row(5), nint(row(6)), row(7:)
         end associate
      end do
      close (unit)
   end subroutine write_history

   !! One row per attempt; a failed one carries a U, and the times show where the analysis stands after it.
   subroutine write_increments(path, history, message)
      character(len=*), intent(in) :: path
      type(history_record), intent(in) :: history
      character(len=:), allocatable, intent(inout) :: message
      integer :: unit, i, outcome
      character(len=6) :: attempt
      call open_new(path, unit, message)
      if (len(message) > 0) return
      write (unit, '(a)') ' STEP   INC   ATT  EQUIL      TOTAL TIME       STEP TIME     INC OF TIME  NOTE'
      write (unit, '(a)') '                   ITERS'
      do i = 1, history%n_attempts
         associate (row => history%attempts(:, i))
            outcome = nint(row(8))
            write (attempt, '(i0)') nint(row(3))
            if (outcome /= outcome_converged .and. outcome /= outcome_rounding) attempt = trim(attempt)//'U'
            write (unit, '(i5,i6,a6,i7,3es16.7e3,2x,a)') nint(row(1:2)), adjustr(attempt), nint(row(4)), row(5:7), &
               outcome_text(outcome)
         end associate
      end do
      write (unit, '(/,a)') merge(' THE ANALYSIS HAS COMPLETED SUCCESSFULLY', &
                                  ' THE ANALYSIS HAS NOT BEEN COMPLETED    ', history%completed)
      close (unit)
   end subroutine write_increments
end module driver_output
