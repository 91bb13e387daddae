module deck_record
  !! One record of a deck: a logical line split into items, with access by position and by keyword.
  !! Items are separated by blanks, one comma or one `=`. Two commas in a row (or a comma or `=`
  !! without anything before it) hold an empty item, which reads as 0 or as a blank name; one comma
  !! at the end holds nothing. Blanks, commas and `=` inside quotes or parentheses do not separate,
  !! neither does the `=` of ==, /=, <=, >=. So an expression is one item if it has no blanks
  !! outside parentheses: `2*a`, `(2 * a)`, `max(a, b)`, but not `2 * a`.
  !!
  !!     type(record) :: rec
  !!     rec%count               number of items
  !!     rec%is_blank            the line that ends a data set (rec%ends_set: or end of deck)
  !!     rec%end_of_deck         nothing follows
  !!     rec%word(i)             the item as written, without quotes; '' if there is none
  !!     rec%key(i)              its first four letters in lower case, which decide a command
  !!     rec%command             the command that the record belongs to, for messages: CONTact
  !!     rec%at                  file and line (rec%place_of(i): of item i of a continued line)
  !!     call rec%number(i, x, log, 'thickness' [, default])     a number or an expression
  !!     call rec%integer(i, n, log, 'degree' [, default])       the same, whole
  !!     call rec%text(i, name, log, 'surface name' [, default]) a name
  !!     call rec%numbers(i, x(:), log, 'coordinates')           size(x) of them, from item i on
  !!     call rec%integers(i, n(:), log, 'node numbers')
  !!     rec%has('slave')        is there an item slave (first four letters, not in quotes)?
  !!     rec%find('slave')       index of the item after it (slave=TOP, slave TOP), else 0
  !!     call rec%number_option('penalty', x, log)     x stays if the option is not there
  !!     call rec%integer_option(...), call rec%text_option(...)
  !!     call rec%check_options([character(8) :: 'slave', 'penalty'], log)    no other `key=`
  !!     call rec%check_count(least, most, log, 'name, degree, ids')          number of items
  !!     call rec%add_error(log, fact, remedy [, i])    a message at this record (item i)
  !!
  !! Missing items are errors where no default is given; an empty item is the default, or 0, or
  !! blank. After an error the value is 0 (or ''), so that reading goes on and finds the other
  !! errors. What depends on a parameter whose own error was reported gives 0 silently.
  use kinds, only: wp
  use messages, only: deck_place, message_log, name_hint, lower_case, quoted, whole_text
  use number_text, only: read_number, write_number, equal
  use logical_lines, only: logical_line
  use expressions, only: symbol_source, value, expression_problem, evaluate, &
    unknown_value, word_value
  implicit none (type, external)
  private
  public :: record

  type :: record
    type(deck_place) :: at                  !! where the record begins
    integer :: count = 0                    !! items
    logical :: is_blank = .false.
    logical :: end_of_deck = .false.
    logical :: ends_set = .false.           !! blank or end of deck
    logical :: is_damaged = .false.         !! an error of this line was reported: no others are
    character(:), allocatable :: command    !! that it belongs to, for messages
    type(logical_line) :: line              !! after substitution
    integer, allocatable, private :: first(:), last(:)    ! characters of the items
    logical, allocatable, private :: in_quotes(:)
    logical, allocatable, private :: named(:)             ! an = follows
    class(symbol_source), pointer, private :: symbols => null()
  contains
    procedure :: split
    procedure :: word
    procedure :: key
    procedure :: is_quoted, is_named
    procedure :: place_of
    procedure :: rest
    procedure :: number => record_number
    procedure :: integer => record_integer
    procedure :: text => record_text
    procedure :: numbers => record_numbers
    procedure :: integers => record_integers
    procedure :: item_value
    procedure :: has
    procedure :: find
    procedure :: number_option
    procedure :: integer_option
    procedure :: text_option
    procedure :: check_options
    procedure :: check_count
    procedure :: add_error => record_error
    procedure :: add_warning => record_warning
    procedure, private :: keyword
    procedure, private :: is_given
    procedure, private :: store
  end type record

contains

  subroutine split(self, symbols, log)
    !! Finds the items of self%line.
    class(record), intent(inout) :: self
    class(symbol_source), pointer, intent(in) :: symbols   !! for expressions
    type(message_log), intent(inout) :: log

    self%symbols => symbols
    self%count = 0
    self%at = self%line%at
    self%is_blank = self%line%n == 0
    self%ends_set = self%is_blank
    self%end_of_deck = .false.
    call find_items(self, self%line%text(1:self%line%n), log)
  end subroutine split

  subroutine find_items(self, text, log)
    class(record), intent(inout) :: self
    character(*), intent(in) :: text         ! self%line
    type(message_log), intent(inout) :: log
    integer :: pos, first, depth, n
    logical :: open_place, in_quotes

    n = len(text)
    open_place = .true.
    pos = 1
    do while (pos <= n)
      select case (text(pos:pos))
      case (' ')
        pos = pos + 1
      case (',', '=')
        if (open_place) call self%store(pos, pos - 1)
        if (text(pos:pos) == '=') self%named(self%count) = .true.
        open_place = .true.
        pos = pos + 1
      case default
        first = pos
        depth = 0
        in_quotes = .false.
        do while (pos <= n)
          select case (text(pos:pos))
          case ('"')
            in_quotes = .not. in_quotes
          case ('(')
            if (.not. in_quotes) depth = depth + 1
          case (')')
            if (.not. in_quotes) depth = max(0, depth - 1)
          case (' ', ',')
            if (depth == 0 .and. .not. in_quotes) exit
          case ('=')
            if (depth == 0 .and. .not. in_quotes) then
              if (.not. is_comparison(text(first:n), pos - first + 1)) exit
            end if
          end select
          pos = pos + 1
        end do
        call self%store(first, pos - 1)
        open_place = .false.
        if (in_quotes) then
          call self%add_error(log, 'the quotes of ' // quoted(text(first:pos-1)) // &
            ' are not closed', '')
          self%is_damaged = .true.
        else if (depth > 0) then
          call self%add_error(log, 'a parenthesis of ' // quoted(text(first:pos-1)) // &
            ' is not closed', '')
          self%is_damaged = .true.
        end if
      end select
    end do
  end subroutine find_items

  pure logical function is_comparison(text, i)
    !! Does the = at character i belong to ==, /=, <= or >=?
    character(*), intent(in) :: text
    integer, intent(in) :: i

    is_comparison = .false.
    if (i > 1) is_comparison = scan(text(i-1:i-1), '=/<>') > 0
    if (i < len(text) .and. .not. is_comparison) is_comparison = text(i+1:i+1) == '='
  end function is_comparison

  subroutine store(self, first, last)
    class(record), intent(inout) :: self
    integer, intent(in) :: first, last       ! characters of the item; last < first: empty
    integer :: n

    if (.not. allocated(self%first)) then
      allocate (self%first(16), self%last(16), self%in_quotes(16), self%named(16))
    else if (self%count == size(self%first)) then
      n = self%count
      self%first = [self%first, spread(0, 1, n)]
      self%last = [self%last, spread(0, 1, n)]
      self%in_quotes = [self%in_quotes, spread(.false., 1, n)]
      self%named = [self%named, spread(.false., 1, n)]
    end if
    self%count = self%count + 1
    n = self%count
    self%first(n) = first
    self%last(n) = last
    self%in_quotes(n) = .false.
    self%named(n) = .false.
    if (last <= first) return
    if (self%line%text(first:first) /= '"' .or. self%line%text(last:last) /= '"') return
    if (index(self%line%text(first+1:last-1), '"') > 0) return
    self%in_quotes(n) = .true.
    self%first(n) = first + 1
    self%last(n) = last - 1
  end subroutine store

  pure function word(self, i)
    class(record), intent(in) :: self
    integer, intent(in) :: i
    character(:), allocatable :: word       !! the item as written, without quotes

    if (i >= 1 .and. i <= self%count) then
      word = self%line%text(self%first(i):self%last(i))
    else
      word = ''
    end if
  end function word

  pure function key(self, i)
    class(record), intent(in) :: self
    integer, intent(in) :: i
    character(4) :: key                     !! the first four letters in lower case

    key = ''
    if (i < 1 .or. i > self%count) return
    key = lower_case(self%line%text(self%first(i):min(self%last(i), self%first(i) + 3)))
  end function key

  pure logical function is_quoted(self, i)
    class(record), intent(in) :: self
    integer, intent(in) :: i

    is_quoted = .false.
    if (i >= 1 .and. i <= self%count) is_quoted = self%in_quotes(i)
  end function is_quoted

  pure logical function is_named(self, i)
    class(record), intent(in) :: self
    integer, intent(in) :: i                !! of an item: an = follows it

    is_named = self%named(i)
  end function is_named

  pure function place_of(self, i) result(at)
    class(record), intent(in) :: self
    integer, intent(in) :: i
    type(deck_place) :: at                  !! of item i (else where the record begins)
    integer :: k

    at = self%at
    if (i < 1 .or. i > self%count) return
    do k = 1, self%line%joins
      if (self%line%join_column(k) > self%first(i)) exit
      at%line = self%line%join_line(k)
    end do
  end function place_of

  pure function rest(self, i)
    class(record), intent(in) :: self
    integer, intent(in) :: i
    character(:), allocatable :: rest       !! the line from item i on, as written

    rest = ''
    if (i < 1 .or. i > self%count) return
    rest = self%line%text(merge(self%first(i) - 1, self%first(i), self%in_quotes(i)):self%line%n)
  end function rest

  pure logical function is_given(self, i)
    !! Is item i there and not empty?
    class(record), intent(in) :: self
    integer, intent(in) :: i

    is_given = .false.
    if (i >= 1 .and. &
      i <= self%count) is_given = self%last(i) >= self%first(i) .or. self%in_quotes(i)
  end function is_given

  subroutine record_number(self, i, x, log, what, default)
    class(record), intent(in) :: self
    integer, intent(in) :: i                          !! item
    real(wp), intent(out) :: x                        !! its value
    type(message_log), intent(inout) :: log
    character(*), intent(in) :: what                  !! what it is, for messages: 'thickness'
    real(wp), intent(in), optional :: default         !! if the item is empty or missing
    integer :: used, n

    x = 0
    if (self%is_given(i)) then
      n = self%last(i) - self%first(i) + 1
      if (.not. self%in_quotes(i)) then
        call read_number(self%line%text(self%first(i):self%last(i)), x, used)
        if (used == n) return
      end if
      call number_of_expression(self, i, x, log, 'a number', what)
    else if (present(default)) then
      x = default
    else if (i > self%count) then
      call missing(self, i, log, 'a number', what)
    end if
  end subroutine record_number

  subroutine number_of_expression(self, i, x, log, expected, what)
    class(record), intent(in) :: self
    integer, intent(in) :: i
    real(wp), intent(out) :: x
    type(message_log), intent(inout) :: log
    character(*), intent(in) :: expected, what
    type(value) :: v

    x = 0
    if (self%in_quotes(i)) then
      call self%add_error(log, 'expected ' // expected // ' for ' // what // &
        ', found the word ' // &
        quoted(self%word(i)), '', i)
      return
    end if
    call self%item_value(i, v, log, expected, what)
    if (v%kind == word_value) then
      call self%add_error(log, 'expected ' // expected // ' for ' // what // ', found ' // &
        quoted(self%word(i)) // ', the word ' // quoted(v%word), '', i)
    else
      x = v%x
    end if
  end subroutine number_of_expression

  subroutine item_value(self, i, v, log, expected, what)
    class(record), intent(in) :: self
    integer, intent(in) :: i                          !! item
    type(value), intent(out) :: v                     !! number or word; unknown after an error
    type(message_log), intent(inout) :: log
    character(*), intent(in) :: expected              !! 'a number'
    character(*), intent(in) :: what                  !! what it is, for messages: 'thickness'
    type(expression_problem) :: problem
    character(:), allocatable :: item, remedy

    if (.not. self%is_given(i)) then
      v%kind = unknown_value
      call missing(self, i, log, expected, what)
      return
    end if
    if (self%in_quotes(i)) then
      v%kind = word_value
      v%word = self%word(i)
      return
    end if
    item = self%word(i)
    call evaluate(item, self%symbols, v, problem)
    if (.not. problem%found) return
    remedy = problem%remedy
    if (problem%name == item) then
      if (i == 1) remedy = remedy // ' If ' // quoted(item) // &
        ' is a command, the blank line before it is missing.'
    else
      remedy = capital(problem%fact) // '. ' // remedy
    end if
    call self%add_error(log, 'expected ' // expected // ' for ' // what // ', found ' // &
      quoted(item), remedy, i)
  end subroutine item_value

  pure function capital(text)
    character(*), intent(in) :: text
    character(len(text)) :: capital

    capital = text
    if (text(1:1) >= 'a' .and. text(1:1) <= 'z') capital(1:1) = achar(iachar(text(1:1)) - 32)
  end function capital

  subroutine record_integer(self, i, n, log, what, default)
    class(record), intent(in) :: self
    integer, intent(in) :: i                          !! item
    integer, intent(out) :: n                         !! its value
    type(message_log), intent(inout) :: log
    character(*), intent(in) :: what                  !! what it is, for messages: 'degree'
    integer, intent(in), optional :: default          !! if the item is empty or missing
    character(:), allocatable :: remedy
    integer :: used, length
    real(wp) :: x

    n = 0
    if (self%is_given(i)) then
      length = self%last(i) - self%first(i) + 1
      used = -1
      if (.not. self%in_quotes(i)) &
        call read_number(self%line%text(self%first(i):self%last(i)), x, used)
      if (used /= length) call number_of_expression(self, i, x, log, 'a whole number', what)
      if (abs(x) <= huge(n)) then
        n = nint(x)
        if (equal(real(n, wp), x)) return
      end if
      n = 0
      remedy = ''
      if (used /= length) remedy = 'That is ' // write_number(x)
      call self%add_error(log, 'expected a whole number for ' // what // ', found ' // &
        quoted(self%word(i)), remedy, i)
    else if (present(default)) then
      n = default
    else if (i > self%count) then
      call missing(self, i, log, 'a whole number', what)
    end if
  end subroutine record_integer

  subroutine record_text(self, i, name, log, what, default)
    class(record), intent(in) :: self
    integer, intent(in) :: i                          !! item
    character(:), allocatable, intent(out) :: name    !! the item without quotes, as written
    type(message_log), intent(inout) :: log
    character(*), intent(in) :: what                  !! what it is, for messages: 'surface name'
    character(*), intent(in), optional :: default     !! if the item is empty or missing

    name = self%word(i)
    if (self%is_given(i) .and. len(name) > 0) return
    if (present(default)) then
      name = default
    else
      call missing(self, i, log, 'a name', what)
    end if
  end subroutine record_text

  subroutine record_numbers(self, i, x, log, what)
    class(record), intent(in) :: self
    integer, intent(in) :: i                          !! first item
    real(wp), intent(out) :: x(:)                     !! items i, i+1, ...
    type(message_log), intent(inout) :: log
    character(*), intent(in) :: what                  !! what they are, for messages: 'coordinates'
    integer :: k

    x = 0
    if (too_few(self, i, size(x), log, what)) return
    do k = 1, size(x)
      call self%number(i + k - 1, x(k), log, what)
    end do
  end subroutine record_numbers

  subroutine record_integers(self, i, n, log, what)
    class(record), intent(in) :: self
    integer, intent(in) :: i                          !! first item
    integer, intent(out) :: n(:)                      !! items i, i+1, ...
    type(message_log), intent(inout) :: log
    character(*), intent(in) :: what                  !! what they are, for messages: 'node numbers'
    integer :: k

    n = 0
    if (too_few(self, i, size(n), log, what)) return
    do k = 1, size(n)
      call self%integer(i + k - 1, n(k), log, what)
    end do
  end subroutine record_integers

  logical function too_few(self, i, n, log, what)
    class(record), intent(in) :: self
    integer, intent(in) :: i, n
    type(message_log), intent(inout) :: log
    character(*), intent(in) :: what

    too_few = self%count < i + n - 1
    if (too_few) call self%add_error(log, 'expected ' // whole_text(n) // ' ' // what // &
      ' from item ' // &
      whole_text(i) // ' on, found ' // whole_text(max(0, self%count - i + 1)), '')
  end function too_few

  subroutine missing(self, i, log, expected, what)
    class(record), intent(in) :: self
    integer, intent(in) :: i
    type(message_log), intent(inout) :: log
    character(*), intent(in) :: expected, what

    if (i <= self%count) then
      call self%add_error(log, 'expected ' // expected // ' for ' // what // &
        ', found an empty item', '', i)
    else if (self%count == 0) then
      call self%add_error(log, 'expected ' // expected // ' for ' // what // &
        ', found a blank line', '')
    else
      call self%add_error(log, 'expected ' // expected // ' for ' // what // ' as item ' // &
        whole_text(i) // ', found the end of the line', '', self%count)
    end if
  end subroutine missing

  logical function has(self, name)
    class(record), intent(in) :: self
    character(*), intent(in) :: name        !! the keyword, of which four letters count

    has = self%keyword(name) > 0
  end function has

  integer function find(self, name)
    class(record), intent(in) :: self
    character(*), intent(in) :: name        !! the keyword, of which four letters count

    find = self%keyword(name)
    if (find > 0) find = find + 1
    if (find > self%count) find = 0
  end function find

  integer function keyword(self, name)
    !! Index of the item; one with an = behind it goes before one without.
    class(record), intent(in) :: self
    character(*), intent(in) :: name
    character(4) :: wanted
    integer :: i

    wanted = lower_case(name(1:min(4, len(name))))
    keyword = 0
    do i = 1, self%count
      if (self%in_quotes(i)) cycle
      if (self%key(i) /= wanted) cycle
      if (keyword == 0) keyword = i
      if (.not. self%named(i)) cycle
      keyword = i
      return
    end do
  end function keyword

  subroutine number_option(self, name, x, log)
    class(record), intent(in) :: self
    character(*), intent(in) :: name        !! penalty, for penalty=1e5
    real(wp), intent(inout) :: x            !! stays if there is no such option
    type(message_log), intent(inout) :: log
    integer :: i

    i = self%keyword(name)
    if (i > 0) call self%number(i + 1, x, log, name)
  end subroutine number_option

  subroutine integer_option(self, name, n, log)
    class(record), intent(in) :: self
    character(*), intent(in) :: name        !! gp, for gp=4
    integer, intent(inout) :: n             !! stays if there is no such option
    type(message_log), intent(inout) :: log
    integer :: i

    i = self%keyword(name)
    if (i > 0) call self%integer(i + 1, n, log, name)
  end subroutine integer_option

  subroutine text_option(self, name, text, log)
    class(record), intent(in) :: self
    character(*), intent(in) :: name                        !! slave, for slave=TOP
    character(:), allocatable, intent(inout) :: text        !! stays if there is no such option
    type(message_log), intent(inout) :: log
    integer :: i

    i = self%keyword(name)
    if (i > 0) call self%text(i + 1, text, log, name)
  end subroutine text_option

  subroutine check_options(self, names, log)
    class(record), intent(in) :: self
    character(*), intent(in) :: names(:)    !! the options that the command has
    type(message_log), intent(inout) :: log
    integer :: i, k
    logical :: known

    do i = 1, self%count
      if (.not. self%named(i)) cycle
      known = .false.
      do k = 1, size(names)
        known = known .or. self%key(i) == lower_case(names(k)(1:min(4, len(names))))
      end do
      if (.not. known) call self%add_error(log, 'there is no option ' // quoted(self%word(i)), &
        name_hint(self%word(i), names, 'options'), i)
    end do
  end subroutine check_options

  subroutine check_count(self, least, most, log, what)
    class(record), intent(in) :: self
    integer, intent(in) :: least, most      !! items
    type(message_log), intent(inout) :: log
    character(*), intent(in) :: what        !! the items: 'node, degree, weights'
    character(:), allocatable :: expected

    if (self%count >= least .and. self%count <= most) return
    expected = whole_text(least)
    if (most == huge(most)) then
      expected = 'at least ' // expected
    else if (most > least) then
      expected = expected // ' to ' // whole_text(most)
    end if
    call self%add_error(log, 'expected ' // expected // ' items (' // what // '), found ' // &
      whole_text(self%count), '')
  end subroutine check_count

  subroutine record_error(self, log, fact, remedy, i)
    class(record), intent(in) :: self
    type(message_log), intent(inout) :: log
    character(*), intent(in) :: fact            !! what is wrong
    character(*), intent(in) :: remedy          !! what to do; may be ''
    integer, intent(in), optional :: i          !! the item that is wrong

    if (self%is_damaged) return
    if (present(i)) then
      call log%add_error(self%place_of(i), shown_command(self), fact, remedy)
    else
      call log%add_error(self%at, shown_command(self), fact, remedy)
    end if
  end subroutine record_error

  subroutine record_warning(self, log, fact, remedy)
    class(record), intent(in) :: self
    type(message_log), intent(inout) :: log
    character(*), intent(in) :: fact            !! what is doubtful
    character(*), intent(in) :: remedy          !! what to do; may be ''

    if (.not. self%is_damaged) call log%add_warning(self%at, shown_command(self), fact, remedy)
  end subroutine record_warning

  pure function shown_command(self) result(command)
    class(record), intent(in) :: self
    character(:), allocatable :: command

    command = ''
    if (allocated(self%command)) command = self%command
  end function shown_command
end module deck_record
