module deck_source
  !! The text of a deck: files, those they include, and logical lines.
  !!
  !! A file is read once and kept (the results carry the whole text). It must be text: tabs,
  !! carriage returns and form feeds read as blanks, a byte order mark is skipped, other control
  !! characters make it a binary file. `!` outside quotes begins a comment. A line with nothing but
  !! a comment is skipped; a blank line is a line. A line whose last character is a single `&` goes
  !! on in the next one. There is no longest line.
  !!
  !! Names of included files are relative to the file that includes them.
  use, intrinsic :: iso_fortran_env, only: iostat_end
  use kinds, only: i8
  use messages, only: deck_place, message_log, quoted
  use logical_lines, only: logical_line, blank_line, append_text
  implicit none (type, external)
  private
  public :: source, source_mark, line_read, file_ended, deck_ended

  integer, parameter :: line_read = 0       !! outcomes of next_line
  integer, parameter :: file_ended = 1      !! an included file ended, its includer goes on
  integer, parameter :: deck_ended = 2

  integer, parameter :: deepest = 50        !! files that include each other
  character, parameter :: line_feed = achar(10)
  character(3), parameter :: byte_order_mark = char(239) // char(187) // char(191)

  type :: source_file
    character(:), allocatable :: path
    character(:), allocatable :: text
  end type source_file

  type :: source_mark
    !! A place to return to (the begin of a LOOP).
    private
    integer :: file = 0
    integer(i8) :: next = 1                 ! character that comes next
    integer :: line = 0                     ! line that was read last
  end type source_mark

  type :: source
    private
    type(source_file), allocatable :: files(:)
    type(source_mark), allocatable :: open_files(:)
    integer :: depth = 0                    ! files that are open
    integer :: lines = 0                    ! logical lines so far
    integer, allocatable :: line_file(:), line_number(:)
    logical, public :: keep_comments = .false.   !! does next_line keep what stands behind the `!`?
  contains
    procedure :: open => open_source
    procedure :: include => include_file
    procedure :: next_line
    procedure :: mark
    procedure :: return_to
    procedure :: nesting
    procedure :: place => place_of_order
    procedure :: file_count
    procedure :: file_name
    procedure :: file_text
    procedure, private :: enter
    procedure, private :: register
  end type source

contains

  subroutine open_source(self, path, at, log)
    class(source), intent(inout) :: self
    character(*), intent(in) :: path        !! the deck
    type(deck_place), intent(in) :: at      !! who asks for it, for messages
    type(message_log), intent(inout) :: log

    allocate (self%files(0), self%open_files(deepest))
    allocate (self%line_file(1024), self%line_number(1024))
    call self%enter(path, at, '', log)
  end subroutine open_source

  subroutine include_file(self, name, at, log)
    class(source), intent(inout) :: self
    character(*), intent(in) :: name        !! as the deck writes it
    type(deck_place), intent(in) :: at      !! the place of the INCLude
    type(message_log), intent(inout) :: log
    character(:), allocatable :: path, chain
    integer :: i

    path = name
    if (name(1:min(1, len(name))) /= '/') then
      i = index(self%files(self%open_files(self%depth)%file)%path, '/', back=.true.)
      path = self%files(self%open_files(self%depth)%file)%path(1:i) // name
    end if
    path = simple_path(path)
    chain = ''
    do i = 1, self%depth
      if (self%files(self%open_files(i)%file)%path == path .or. len(chain) > 0) &
        chain = chain // self%files(self%open_files(i)%file)%path // ' -> '
    end do
    if (len(chain) > 0) then
      call log%add_error(at, 'INCLude', quoted(name) // ' includes itself: ' // chain // path, '')
    else if (self%depth == deepest) then
      call log%add_error(at, 'INCLude', 'too many files include each other', '')
    else
      call self%enter(path, at, 'INCLude', log)
    end if
  end subroutine include_file

  pure function simple_path(path) result(simple)
    !! Without `.` and `name/..`, so that a file has one name (links aside).
    character(*), intent(in) :: path
    character(:), allocatable :: simple
    character(:), allocatable :: part
    integer :: first, last

    simple = ''
    first = 1
    do while (first <= len(path))
      last = index(path(first:), '/')
      if (last == 0) then
        last = len(path)
      else
        last = first + last - 1
      end if
      part = path(first:last)
      first = last + 1
      if (part == './' .or. (part == '/' .and. len(simple) > 0)) cycle
      if (part == '../' .and. len(simple) > 1) then
        last = index(simple(1:len(simple)-1), '/', back=.true.)
        if (simple(last+1:) /= '../') then
          simple = simple(1:last)
          cycle
        end if
      end if
      simple = simple // part
    end do
  end function simple_path

  subroutine enter(self, path, at, command, log)
    !! Reads the file, unless it was read before, and goes on at its begin.
    class(source), intent(inout) :: self
    character(*), intent(in) :: path
    type(deck_place), intent(in) :: at
    character(*), intent(in) :: command
    type(message_log), intent(inout) :: log
    type(source_file), allocatable :: longer(:)
    character(:), allocatable :: text, fact
    integer :: i, k

    do i = 1, size(self%files)
      if (self%files(i)%path == path) exit
    end do
    if (i > size(self%files)) then
      call read_text(path, text, fact)
      if (len(fact) > 0) then
        call log%add_error(at, command, fact, '')
        return
      end if
      allocate (longer(i))
      do k = 1, i - 1
        call move_alloc(self%files(k)%path, longer(k)%path)
        call move_alloc(self%files(k)%text, longer(k)%text)
      end do
      longer(i)%path = path
      call move_alloc(text, longer(i)%text)
      call move_alloc(longer, self%files)
    end if
    self%depth = self%depth + 1
    self%open_files(self%depth) = source_mark(file=i)
    k = min(3, len(self%files(i)%text))
    if (self%files(i)%text(1:k) == byte_order_mark) self%open_files(self%depth)%next = 4
  end subroutine enter

  subroutine read_text(path, text, fact)
    character(*), intent(in) :: path
    character(:), allocatable, intent(out) :: text
    character(:), allocatable, intent(out) :: fact    ! what is wrong; '' if all is well
    character(256) :: reason
    integer(i8) :: bytes, i
    integer :: unit, status
    logical :: is_there

    fact = ''
    inquire (file=path, exist=is_there)
    if (.not. is_there) then
      fact = 'there is no file ' // quoted(path)
      return
    end if
    open (newunit=unit, file=path, access='stream', form='unformatted', action='read', &
      status='old', &
      iostat=status, iomsg=reason)
    if (status == 0) then
      inquire (unit=unit, size=bytes)
      allocate (character(max(bytes, 0_i8)) :: text)
      if (bytes > 0) read (unit, iostat=status, iomsg=reason) text
      if (status == iostat_end) status = 0
      close (unit)
      if (status == 0 .and. bytes < 0) then
        status = 1
        reason = 'it is not a regular file'
      end if
    end if
    if (status /= 0) then
      fact = 'the file ' // quoted(path) // ' cannot be read: ' // trim(reason)
      return
    end if
    do i = 1, bytes
      if (is_binary(text(i:i))) then
        fact = 'the file ' // quoted(path) // ' is not a text file'
        return
      end if
    end do
  end subroutine read_text

  pure logical function is_binary(c)
    character, intent(in) :: c

    select case (iachar(c))
    case (0:8, 11, 14:31, 127)
      is_binary = .true.
    case default
      is_binary = .false.
    end select
  end function is_binary

  subroutine next_line(self, line, outcome, log)
    class(source), intent(inout) :: self
    type(logical_line), intent(inout) :: line   !! without blanks at its ends
    integer, intent(out) :: outcome
    type(message_log), intent(inout) :: log
    logical :: comment_only, continues
    integer(i8) :: length

    call blank_line(line)
    if (self%depth == 0) then
      outcome = deck_ended
      return
    end if
    associate (here => self%open_files(self%depth))
      length = len(self%files(here%file)%text, i8)
      do
        if (here%next > length) then
          self%depth = self%depth - 1
          outcome = merge(deck_ended, file_ended, self%depth == 0)
          return
        end if
        call read_line(self%files(here%file)%text, here, line, comment_only, continues, &
          self%keep_comments)
        if (.not. comment_only) exit
      end do
      call self%register(here, line%at)
      outcome = line_read
      do while (continues)
        if (here%next > length) then
          call log%add_error(line%at, '', 'the line ends with &, but the file ends', '')
          exit
        end if
        if (line%joins == size(line%join_line)) then
          line%join_line = [line%join_line, line%join_line]
          line%join_column = [line%join_column, line%join_column]
        end if
        line%joins = line%joins + 1
        line%n = len_trim(line%text(1:line%n))
        call append_text(line, ' ')
        line%join_column(line%joins) = line%n + 1
        call read_line(self%files(here%file)%text, here, line, comment_only, continues, .false.)
        line%join_line(line%joins) = here%line
        continues = continues .or. comment_only
      end do
    end associate
  end subroutine next_line

  subroutine read_line(text, here, line, comment_only, continues, keep_comment)
    !! Appends the line of the file that comes next.
    character(*), intent(in) :: text            ! of the file
    type(source_mark), intent(inout) :: here
    type(logical_line), intent(inout) :: line
    logical, intent(out) :: comment_only        ! nothing but a comment
    logical, intent(out) :: continues           ! ends with &
    logical, intent(in) :: keep_comment
    integer(i8) :: first, last, comment, i
    integer :: begin, k
    logical :: in_quotes, has_control

    first = here%next
    comment = 0
    in_quotes = .false.
    has_control = .false.
    do i = first, len(text, i8)
      select case (text(i:i))
      case (line_feed)
        exit
      case ('"')
        if (comment == 0) in_quotes = .not. in_quotes
      case ('!')
        if (comment == 0 .and. .not. in_quotes) comment = i
      case (:achar(9), achar(11):achar(31))
        has_control = .true.
      end select
    end do
    here%next = i + 1
    here%line = here%line + 1
    last = i - 1
    if (comment > 0) then
      if (keep_comment) line%comment = without_controls(text(comment+1:last))
      last = comment - 1
    end if

    do while (first <= last)
      if (.not. is_blank(text(first:first))) exit
      first = first + 1
    end do
    do while (first <= last)
      if (.not. is_blank(text(last:last))) exit
      last = last - 1
    end do
    comment_only = comment > 0 .and. last < first
    continues = .false.
    if (last < first) return
    if (text(last:last) == '&') then
      continues = .true.
      if (last > first) continues = text(last-1:last-1) /= '&'
      if (continues) last = last - 1
    end if
    begin = line%n
    call append_text(line, text(first:last))
    if (.not. has_control) return
    do k = begin + 1, line%n
      if (is_blank(line%text(k:k))) line%text(k:k) = ' '
    end do
  end subroutine read_line

  pure logical function is_blank(c)
    character, intent(in) :: c

    is_blank = c == ' ' .or. (iachar(c) >= 9 .and. iachar(c) <= 13)
  end function is_blank

  pure function without_controls(text) result(clean)
    character(*), intent(in) :: text
    character(:), allocatable :: clean
    integer :: i

    clean = text
    do i = 1, len(clean)
      if (is_blank(clean(i:i))) clean(i:i) = ' '
    end do
    clean = trim(adjustl(clean))
  end function without_controls

  subroutine register(self, here, at)
    !! Gives the line its number in the order of reading.
    class(source), intent(inout) :: self
    type(source_mark), intent(in) :: here
    type(deck_place), intent(inout) :: at

    if (self%lines == size(self%line_file)) then
      self%line_file = [self%line_file, self%line_file]
      self%line_number = [self%line_number, self%line_number]
    end if
    self%lines = self%lines + 1
    self%line_file(self%lines) = here%file
    self%line_number(self%lines) = here%line
    at%file = self%files(here%file)%path
    at%line = here%line
    at%order = self%lines
  end subroutine register

  function mark(self)
    class(source), intent(in) :: self
    type(source_mark) :: mark               !! behind the line that was read last

    mark = self%open_files(self%depth)
  end function mark

  subroutine return_to(self, mark)
    class(source), intent(inout) :: self
    type(source_mark), intent(in) :: mark   !! in the file that is being read

    self%open_files(self%depth) = mark
  end subroutine return_to

  pure integer function nesting(self)
    !! Files that are open: 1 in the deck itself, 0 at its end.
    class(source), intent(in) :: self

    nesting = self%depth
  end function nesting

  function place_of_order(self, order) result(at)
    class(source), intent(in) :: self
    integer, intent(in) :: order            !! deck_place%order of a line that was read
    type(deck_place) :: at

    at%file = self%files(self%line_file(order))%path
    at%line = self%line_number(order)
    at%order = order
  end function place_of_order

  pure integer function file_count(self)
    !! Files read so far; the first is the deck.
    class(source), intent(in) :: self

    file_count = size(self%files)
  end function file_count

  function file_name(self, i) result(path)
    class(source), intent(in) :: self
    integer, intent(in) :: i
    character(:), allocatable :: path

    path = self%files(i)%path
  end function file_name

  function file_text(self, i) result(text)
    class(source), intent(in) :: self
    integer, intent(in) :: i
    character(:), allocatable :: text       !! as it is in the file

    text = self%files(i)%text
  end function file_text
end module deck_source
