!! plyflow-driver CASE: a material point through the programme of a case file.
!! Exit status: 0 completed, 1 the analysis failed, 2 the case cannot be run.
program plyflow_driver
   use, intrinsic :: iso_fortran_env, only: error_unit
   use driver_kinds, only: dp
   use driver_case_keys, only: case_file
   use driver_case_reader, only: read_case
   use driver_history, only: history_record
   use driver_analysis, only: run_analysis
   use driver_output, only: write_history, write_increments
   use driver_replay, only: write_replay
   implicit none
   type(case_file) :: case
   type(history_record) :: history
   character(len=:), allocatable :: path

   path = first_argument()
   if (path == '--help' .or. path == '-h') then
      write (*, '(a)') usage()
      stop
   end if
   if (len(path) == 0) call give_up(usage())
   call read_case(path, case)
   if (len(case%message) > 0) call give_up(case%message)
   call run_analysis(case%problem, history)
   if (history%n_states == 0) call give_up(path//': '//history%message)
   if (case%history /= 'none') call write_history(case%history, history, case%message)
   if (case%increments /= 'none') call write_increments(case%increments, history, case%message)
   if (len(case%message) > 0) call give_up(case%message)
   call report(case, history)
   if (.not. history%completed) stop 1, quiet=.true.
contains
   function first_argument() result(text)
      character(len=:), allocatable :: text
      integer :: length
      text = ''
      if (command_argument_count() /= 1) return
      call get_command_argument(1, length=length)
      text = repeat(' ', length)
      call get_command_argument(1, value=text)
   end function first_argument

   pure function usage() result(text)
      character(len=:), allocatable :: text
      text = 'usage: plyflow-driver CASE'//new_line('a')// &
             'CASE is a text file; driver/README.md describes it. Writes the history (.csv), the increment table'// &
             new_line('a')//'(.sta), and, if an increment fails, a case that repeats it (.replay.txt).'
   end function usage

   subroutine give_up(text)
      character(len=*), intent(in) :: text
      write (error_unit, '(2a)') 'plyflow-driver: ', text
      stop 2, quiet=.true.
   end subroutine give_up

   subroutine report(case, history)
      type(case_file), intent(inout) :: case
      type(history_record), intent(in) :: history
      integer :: iterations
      iterations = nint(sum(history%attempts(4, :history%n_attempts)))
      write (*, '(a,4(i0,a))') merge('completed: ', 'failed:    ', history%completed), history%n_states - 1, &
         ' increments, ', iterations, ' iterations, ', history%n_attempts - history%n_states + 1, &
         ' failed attempts, ', history%umat_calls, ' calls of the UMAT'
      write (*, '(3a)') 'written: ', case%history, ', '//case%increments
      if (history%worst_tangent(2) > 0.0_dp) write (*, '(a,es9.2,a,i0,a,2i2)') 'largest difference of DDSDDE:', &
         history%worst_tangent(1), ' of its largest entry, state ', nint(history%worst_tangent(2)) - 1, &
         ', entry', nint(history%worst_tangent(3:4))
      if (len(history%warnings) > 0) write (error_unit, '(a)') history%warnings
      if (history%completed) return
      write (error_unit, '(3a)') 'plyflow-driver: ', history%message
      if (.not. history%failure%dt > 0.0_dp .or. case%replay == 'none') return
      call write_replay(case%replay, case%library, case%symbol, case%problem, history, case%message)
      write (error_unit, '(2a)') 'repeat the increment with: plyflow-driver ', case%replay
   end subroutine report
end program plyflow_driver
