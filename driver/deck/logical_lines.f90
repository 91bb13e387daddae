module logical_lines
  !! A line of a deck as it counts: without comment, with its continuations, and the places where those began.
  use messages, only: deck_place
  implicit none (type, external)
  private
  public :: logical_line, blank_line, append_text

  type :: logical_line
    !! A line without comment, its continuations joined. Buffers only grow, so that reading
    !! allocates nothing.
    character(:), allocatable :: text       !! text(1:n) counts
    integer :: n = 0
    type(deck_place) :: at                  !! where it begins
    integer :: joins = 0                    !! continuations
    integer, allocatable :: join_column(:)  !! character of text where continuation k begins
    integer, allocatable :: join_line(:)    !! its line in the file
    character(:), allocatable :: comment    !! of the first line, kept only if asked for
  end type logical_line

contains

  pure subroutine blank_line(line)
    !! Empties the line and keeps its buffers.
    type(logical_line), intent(inout) :: line

    line%n = 0
    line%joins = 0
    if (.not. allocated(line%text)) then
      allocate (character(256) :: line%text)
      allocate (line%join_column(4), line%join_line(4))
    end if
    if (allocated(line%comment)) deallocate (line%comment)
  end subroutine blank_line

  pure subroutine append_text(line, text)
    type(logical_line), intent(inout) :: line
    character(*), intent(in) :: text
    character(:), allocatable :: larger

    if (line%n + len(text) > len(line%text)) then
      allocate (character(2*(line%n + len(text))) :: larger)
      larger(1:line%n) = line%text(1:line%n)
      call move_alloc(larger, line%text)
    end if
    line%text(line%n+1:line%n+len(text)) = text
    line%n = line%n + len(text)
  end subroutine append_text
end module logical_lines
