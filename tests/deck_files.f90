module deck_files
  !! Small text files that the tests of the deck reader write into their working folder and remove
  !! again.
  implicit none (type, external)
  private
  public :: write_lines, write_bytes, remove_file

contains

  subroutine write_lines(path, lines)
    character(*), intent(in) :: path
    character(*), intent(in) :: lines(:)     !! blanks at their ends are not written
    integer :: unit, i

    open (newunit=unit, file=path, status='replace', action='write')
    do i = 1, size(lines)
      write (unit, '(a)') trim(lines(i))
    end do
    close (unit)
  end subroutine write_lines

  subroutine write_bytes(path, bytes)
    character(*), intent(in) :: path
    character(*), intent(in) :: bytes        !! the whole file
    integer :: unit

    open (newunit=unit, file=path, status='replace', action='write', access='stream', &
      form='unformatted')
    write (unit) bytes
    close (unit)
  end subroutine write_bytes

  subroutine remove_file(path)
    character(*), intent(in) :: path
    integer :: unit, status

    open (newunit=unit, file=path, status='old', iostat=status)
    if (status == 0) close (unit, status='delete')
  end subroutine remove_file
end module deck_files
