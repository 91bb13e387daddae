module deck_blocks
  !! The blocks IF ... ENDIf and LOOP ... NEXT of a deck that are open: whether the lines in them are read, and messages
  !! about blocks that end too late or never. What the words do with them: module deck_reader.
  use messages, only: deck_place, message_log
  use deck_source, only: source_mark
  implicit none (type, external)
  private
  public :: control_block, block_stack, if_block, loop_block

  integer, parameter :: if_block = 1
  integer, parameter :: loop_block = 2

  type :: control_block
    integer :: kind = if_block
    type(deck_place) :: at                       ! the line that opens it
    integer :: nesting = 0                       ! files open there
    logical :: outer_active = .true.             ! is the block itself read?
    logical :: active = .true.                   ! are its lines read?
    logical :: taken = .false.                   ! IF: a branch was read
    logical :: has_else = .false.
    integer :: pass = 1, passes = 1              ! LOOP
    character(:), allocatable :: counter
    type(source_mark) :: begin
  end type control_block

  type :: block_stack
    type(control_block), allocatable :: list(:)  !! list(count) is the innermost one
    integer :: count = 0
    logical :: active = .true.                   !! are lines read now?
  contains
    procedure :: push => push_block
    procedure :: pop => pop_block
    procedure :: find => find_block
    procedure :: close => close_blocks
    procedure :: loop_is_skipped
  end type block_stack

contains

  subroutine push_block(self, block, nesting, at)
    class(block_stack), intent(inout) :: self
    type(control_block), intent(in) :: block
    integer, intent(in) :: nesting               !! files open now
    type(deck_place), intent(in) :: at
    type(control_block), allocatable :: longer(:)

    if (.not. allocated(self%list)) allocate (self%list(4))
    if (self%count == size(self%list)) then
      allocate (longer(2*self%count))
      longer(1:self%count) = self%list
      call move_alloc(longer, self%list)
    end if
    self%count = self%count + 1
    self%list(self%count) = block
    self%list(self%count)%at = at
    self%list(self%count)%nesting = nesting
    self%active = block%active
  end subroutine push_block

  subroutine pop_block(self)
    class(block_stack), intent(inout) :: self

    self%active = self%list(self%count)%outer_active
    self%count = self%count - 1
  end subroutine pop_block

  logical function find_block(self, kind, nesting, command, at, log)
    !! Is the innermost block of this file of this kind? Others inside it are reported and closed.
    class(block_stack), intent(inout) :: self
    integer, intent(in) :: kind
    integer, intent(in) :: nesting               !! files open now
    character(*), intent(in) :: command
    type(deck_place), intent(in) :: at
    type(message_log), intent(inout) :: log
    integer :: i

    find_block = .false.
    do i = self%count, 1, -1
      if (self%list(i)%nesting /= nesting) exit
      find_block = self%list(i)%kind == kind
      if (find_block) exit
    end do
    if (.not. find_block) then
      call log%add_error(at, command, 'there is no ' // trim(opener(kind)) // &
        ' before it in this file', '')
      return
    end if
    do while (self%count > i)
      call report_open(self%list(self%count), log)
      call self%pop()
    end do
  end function find_block

  subroutine close_blocks(self, nesting, log)
    !! At the end of a file: what begins in it must have ended.
    class(block_stack), intent(inout) :: self
    integer, intent(in) :: nesting               !! files still open
    type(message_log), intent(inout) :: log

    do while (self%count > 0)
      if (self%list(self%count)%nesting <= nesting) return
      call report_open(self%list(self%count), log)
      call self%pop()
    end do
  end subroutine close_blocks

  logical function loop_is_skipped(self)
    !! Are lines left out because of a LOOP without passes? (Where an IF leaves them out, its
    !! solution part may hold LOOP and NEXT of another kind.)
    class(block_stack), intent(in) :: self
    integer :: i

    loop_is_skipped = .false.
    do i = 1, self%count
      if (self%list(i)%active) cycle
      loop_is_skipped = self%list(i)%kind == loop_block
      return
    end do
  end function loop_is_skipped

  subroutine report_open(block, log)
    type(control_block), intent(in) :: block
    type(message_log), intent(inout) :: log

    call log%add_error(block%at, trim(opener(block%kind)), 'this ' // trim(opener(block%kind)) // &
      ' is not closed', merge('Its ENDIf is missing.', 'Its NEXT is missing. ', &
        block%kind == if_block))
  end subroutine report_open

  pure function opener(kind)
    integer, intent(in) :: kind
    character(4) :: opener

    opener = merge('IF  ', 'LOOP', kind == if_block)
  end function opener
end module deck_blocks
