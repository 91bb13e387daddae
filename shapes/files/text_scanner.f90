module text_scanner
  !! Words and numbers of a text file, line by line. Blanks, tabs, commas and carriage returns
  !! separate; a comment runs from its character to the end of the line; lines without words do
  !! not count. A list of numbers begins on a line of its own and may go on over further lines,
  !! but shares no line with the next list, so that a list of the wrong length is found where it
  !! stands.
  use kinds, only: wp, i8
  use number_text, only: read_number
  implicit none (type, external)
  private
  public :: scanner_type, list_type
  public :: list_done, list_ended, list_short, list_long, list_bad_item, as_whole

  integer, parameter :: list_done = 0        !! as many numbers as wanted
  integer, parameter :: list_ended = 1       !! the file ends before
  integer, parameter :: list_short = 2       !! a word begins the next line before
  integer, parameter :: list_long = 3        !! a line has too many numbers
  integer, parameter :: list_bad_item = 4    !! an item is not a finite number

  character, parameter :: line_feed = achar(10), tab = achar(9), carriage_return = achar(13)

  type :: list_type
    !! What reading a list of numbers came to.
    integer :: status = list_done
    integer :: line = 0                      !! where it began, or of the bad item
    integer :: found = 0                     !! its numbers, or those on its line if too many
    character(:), allocatable :: word        !! the bad item
  end type list_type

  type :: scanner_type
    character(:), allocatable :: text        !! the whole file
    character :: comment = '#'
    integer :: width = 0                     !! of fields that touch each other; 0: none do
    integer(i8) :: pos = 0                   !! next character
    integer(i8) :: line_start = 1            !! first character of the line
    integer :: line = 0                      !! its number
  contains
    procedure :: open => open_text
    procedure :: next_line
    procedure :: next_word
    procedure :: back_to_line
    procedure :: read_rest
    procedure :: read_list
    procedure :: remaining
    procedure, private :: skip_blanks
    procedure, private :: scan_number
  end type scanner_type

contains

  subroutine open_text(self, text, comment)
    class(scanner_type), intent(inout) :: self
    character(*), intent(in) :: text
    character, intent(in) :: comment

    self%text = text
    self%comment = comment
    self%width = 0
    self%pos = 0
    self%line_start = 1
    self%line = 0
  end subroutine open_text

  pure subroutine skip_blanks(self, is_end)
    class(scanner_type), intent(inout) :: self
    logical, intent(out) :: is_end           !! no word follows on this line

    do while (self%pos <= len(self%text, i8))
      select case (self%text(self%pos:self%pos))
      case (' ', ',', tab, carriage_return)
        self%pos = self%pos + 1
      case (line_feed)
        is_end = .true.
        return
      case default
        is_end = self%text(self%pos:self%pos) == self%comment
        return
      end select
    end do
    is_end = .true.
  end subroutine skip_blanks

  pure subroutine next_line(self, found)
    !! Goes to the first word of the next line that has one.
    class(scanner_type), intent(inout) :: self
    logical, intent(out) :: found            !! .false.: the file has ended

    logical :: is_end

    found = .false.
    do
      if (self%pos == 0) then
        self%pos = 1
      else
        do
          if (self%pos > len(self%text, i8)) return
          if (self%text(self%pos:self%pos) == line_feed) exit
          self%pos = self%pos + 1
        end do
        self%pos = self%pos + 1
      end if
      if (self%pos > len(self%text, i8)) return
      self%line = self%line + 1
      self%line_start = self%pos
      call self%skip_blanks(is_end)
      if (is_end) cycle
      found = .true.
      return
    end do
  end subroutine next_line

  pure subroutine back_to_line(self)
    !! The next call of next_line finds this line again.
    class(scanner_type), intent(inout) :: self

    if (self%line == 0) return
    self%pos = self%line_start - 1
    self%line = self%line - 1
  end subroutine back_to_line

  pure subroutine word_bounds(self, first, last)
    class(scanner_type), intent(in) :: self
    integer(i8), intent(in) :: first         !! character that begins a word
    integer(i8), intent(out) :: last         !! its last character

    last = first
    do while (last < len(self%text, i8))
      select case (self%text(last+1:last+1))
      case (' ', ',', tab, carriage_return, line_feed)
        exit
      end select
      if (self%text(last+1:last+1) == self%comment) exit
      last = last + 1
    end do
    if (self%width > 0 .and. last - first >= self%width) &
      last = self%line_start - 1 + ((first - self%line_start) / self%width + 1) * self%width
  end subroutine word_bounds

  pure subroutine next_word(self, word)
    !! The next word of this line.
    class(scanner_type), intent(inout) :: self
    character(:), allocatable, intent(out) :: word   !! '' at the end of the line

    integer(i8) :: last
    logical :: is_end

    call self%skip_blanks(is_end)
    if (is_end) then
      word = ''
      return
    end if
    call word_bounds(self, self%pos, last)
    word = self%text(self%pos:last)
    self%pos = last + 1
  end subroutine next_word

  pure subroutine scan_number(self, x, good)
    !! Of the word that begins here; a word that is none stays.
    class(scanner_type), intent(inout) :: self
    real(wp), intent(out) :: x
    logical, intent(out) :: good

    integer(i8) :: last
    integer :: used

    ! the many zeros and ones of extraction operators
    if (self%pos < len(self%text, i8)) then
      select case (self%text(self%pos+1:self%pos+1))
      case (' ', line_feed)
        used = iachar(self%text(self%pos:self%pos)) - iachar('0')
        if (used >= 0 .and. used <= 9) then
          x = used
          good = .true.
          self%pos = self%pos + 1
          return
        end if
      end select
    end if
    call word_bounds(self, self%pos, last)
    call read_number(self%text(self%pos:last), x, used)
    good = used == last - self%pos + 1
    if (good) self%pos = last + 1
  end subroutine scan_number

  pure subroutine read_rest(self, values, n, word)
    !! All numbers to the end of the line.
    class(scanner_type), intent(inout) :: self
    real(wp), intent(out) :: values(:)       !! the first of them
    integer, intent(out) :: n                !! how many there are, also beyond size(values)
    character(:), allocatable, intent(out) :: word   !! an item that is no number; else ''

    real(wp) :: x
    logical :: is_end, good

    values = 0
    n = 0
    word = ''
    do
      call self%skip_blanks(is_end)
      if (is_end) return
      call self%scan_number(x, good)
      if (.not. good) then
        call self%next_word(word)
        return
      end if
      n = n + 1
      if (n <= size(values)) values(n) = x
    end do
  end subroutine read_rest

  pure subroutine read_list(self, values, list)
    class(scanner_type), intent(inout) :: self
    real(wp), intent(out) :: values(:)       !! as many as wanted
    type(list_type), intent(out) :: list

    real(wp) :: x
    integer :: n, n_before
    logical :: found, is_end, good

    values = 0
    n = 0
    do while (n < size(values))
      call self%next_line(found)
      if (.not. found) then
        list%status = list_ended
        if (list%line == 0) list%line = max(1, self%line)
        list%found = n
        return
      end if
      if (list%line == 0) list%line = self%line
      n_before = n
      do
        call self%skip_blanks(is_end)
        if (is_end) exit
        call self%scan_number(x, good)
        if (.not. good) then
          if (n == n_before .and. begins_word(self)) then
            list%status = list_short
            list%found = n
            call self%back_to_line()
          else
            list%status = list_bad_item
            list%line = self%line
            call self%next_word(list%word)
          end if
          return
        end if
        n = n + 1
        if (n <= size(values)) values(n) = x
      end do
      if (n <= size(values)) cycle
      ! either this line is too long, or the one that began the list was too short
      list%status = list_long
      list%found = n
      if (self%line > list%line) list%found = n_before
    end do
  end subroutine read_list

  pure logical function begins_word(self)
    !! A letter that begins no nan or infinity.
    class(scanner_type), intent(in) :: self

    character(3) :: start
    integer(i8) :: last

    call word_bounds(self, self%pos, last)
    start = self%text(self%pos:min(last, self%pos+2))
    begins_word = scan(start(1:1), 'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ') > 0 &
      .and. all(start /= ['nan', 'NaN', 'NAN', 'inf', 'Inf', 'INF'])
  end function begins_word

  pure integer(i8) function remaining(self)
    !! Characters not read yet.
    class(scanner_type), intent(in) :: self

    remaining = len(self%text, i8) - max(self%pos, 1_i8) + 1
  end function remaining

  elemental subroutine as_whole(x, i, good)
    real(wp), intent(in) :: x
    integer, intent(out) :: i                !! 0 if it is none
    logical, intent(out) :: good             !! x is a whole number in the range of integers

    i = 0
    good = abs(x) < real(huge(i), wp)
    if (.not. good) return
    i = nint(x)
    good = .not. abs(x - i) > 0
  end subroutine as_whole
end module text_scanner
