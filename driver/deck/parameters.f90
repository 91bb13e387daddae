module parameters
  !! Parameters and tables of a deck.
  !!
  !!     PARAmeter
  !!       basis = "N" [L N T]          ! a word, and the words that are allowed
  !!       p     = 3   [integer 1:5]    ! a number and its range; [1:], [:5], [1 2 4], [integer]
  !!       h     = 2*pi/p               ! follows from others; blanks are allowed on the right side
  !!
  !!     TABLe nx                       ! nx(row key, column key) in expressions
  !!             1    2    3            ! column keys
  !!       L3   10   20   40            ! row key, then numbers, expressions or words in quotes
  !!
  !! The first value that a deck gives to a name is its default: a setting of the command line takes
  !! its place, and what the deck computes from it follows. Later values of the same name (`n = n +
  !! 1`) count as they stand. The deck decides what is a word and what is a number. A setting may be
  !! an expression of the parameters before it. Names are found in any case; words keep their
  !! spelling, or take that of the list of allowed words.
  use kinds, only: wp
  use messages, only: string, deck_place, message_log, name_hint, known_names, lower_case, &
    quoted, in_place
  use number_text, only: write_number, equal
  use expressions, only: symbol_source, value, expression_problem, evaluate, is_name, &
    is_reserved, value_text, &
    unknown_value, number_value, word_value
  use deck_record, only: record
  use deck_tables, only: table_list
  implicit none (type, external)
  private
  public :: deck_parameters, setting, command_line_place

  type :: setting
    !! name=value of the command line.
    character(:), allocatable :: name, text
  end type setting

  type :: value_domain
    !! What a parameter may be; everything if nothing is stored.
    logical :: is_given = .false.
    logical :: is_integer = .false.
    logical :: has_range = .false.
    real(wp) :: least = -huge(1.0_wp), most = huge(1.0_wp)
    type(value), allocatable :: choices(:)
  end type value_domain

  type :: parameter_entry
    character(:), allocatable :: name       ! as the deck writes it
    character(:), allocatable :: key        ! in lower case
    character(:), allocatable :: comment    ! of its line in the deck
    type(value) :: v
    type(value_domain) :: domain
    type(deck_place) :: at                  ! where it got its default
    logical :: is_counter = .false.         ! of a LOOP
    logical :: is_set = .false.             ! by the command line
  end type parameter_entry

  type, extends(symbol_source) :: deck_parameters
    private
    type(parameter_entry), allocatable :: list(:)
    type(table_list) :: tables
    type(setting), allocatable :: settings(:)
    logical, allocatable :: used(:)         ! settings that the deck has asked for
  contains
    procedure :: start
    procedure :: assign
    procedure :: set_counter
    procedure :: begin_table
    procedure :: add_table_line
    procedure :: check_settings
    procedure :: count => parameter_count
    procedure :: name => parameter_name
    procedure :: text => parameter_text
    procedure :: comment => parameter_comment
    procedure :: find_symbol
    procedure :: has_table
    procedure :: has_key
    procedure :: look_up
    procedure :: symbol_hint
    procedure, private :: index_of
    procedure, private :: add_entry
    procedure, private :: names
    procedure, private :: use_setting
  end type deck_parameters

contains

  pure function command_line_place() result(at)
    !! The place of messages about the command line.
    type(deck_place) :: at

    at%file = 'command line'
  end function command_line_place

  subroutine start(self, settings)
    class(deck_parameters), intent(inout) :: self
    type(setting), intent(in) :: settings(:)          !! of the command line

    self%settings = settings
    allocate (self%used(size(settings)))
    self%used = .false.
    allocate (self%list(0))
    call self%tables%start()
  end subroutine start

  integer function parameter_count(self)
    class(deck_parameters), intent(in) :: self
    parameter_count = size(self%list)
  end function parameter_count

  function parameter_name(self, i) result(name)
    class(deck_parameters), intent(in) :: self
    integer, intent(in) :: i
    character(:), allocatable :: name       !! as the deck writes it
    name = self%list(i)%name
  end function parameter_name

  function parameter_text(self, i) result(text)
    class(deck_parameters), intent(in) :: self
    integer, intent(in) :: i
    character(:), allocatable :: text       !! its value now
    text = value_text(self%list(i)%v)
  end function parameter_text

  function parameter_comment(self, i) result(text)
    class(deck_parameters), intent(in) :: self
    integer, intent(in) :: i
    character(:), allocatable :: text       !! the comment of its line; may be ''
    text = self%list(i)%comment
  end function parameter_comment

  subroutine assign(self, line, comment, is_damaged, at, log)
    class(deck_parameters), intent(inout) :: self
    character(*), intent(in) :: line        !! name = expression [what is allowed]
    character(*), intent(in) :: comment     !! what the deck says behind it
    logical, intent(in) :: is_damaged       !! its error was reported: the value is unknown
    type(deck_place), intent(in) :: at
    type(message_log), intent(inout) :: log
    character(*), parameter :: command = 'PARAmeter'
    type(expression_problem) :: problem
    type(value_domain) :: domain
    type(value) :: v
    character(:), allocatable :: name, text
    integer :: i, equals, bracket
    logical :: accepted

    equals = index(line, '=')
    if (equals == 0) then
      call log%add_error(at, command, 'expected name = value, found ' // &
        quoted(trim(adjustl(line))), &
        'A blank line ends the parameters.')
      return
    end if
    name = trim(adjustl(line(1:equals-1)))
    if (.not. is_name(name)) then
      call log%add_error(at, command, quoted(name) // ' is no name of a parameter', &
        'A name is a letter, then letters, digits and underscores.')
      return
    else if (is_reserved(name) .or. self%tables%index_of(lower_case(name)) > 0) then
      call log%add_error(at, command, 'the name ' // quoted(name) // &
        ' belongs to a function or table', &
        'Choose another.')
      return
    end if

    bracket = bracket_of(line)
    text = trim(adjustl(line(equals+1:bracket-1)))
    if (.not. is_damaged) call evaluate(text, self, v, problem)
    if (problem%found) then
      if (len(text) > 0 .and. problem%name == text) problem%remedy = &
        'A word is written in quotes, ' // name // ' = "' // text // '". ' // problem%remedy
      call log%add_error(at, command, name // ': ' // problem%fact, problem%remedy)
    end if
    if (bracket <= len(line) .and. .not. is_damaged) call read_domain(self, line(bracket:), v, &
      domain, at, name, log)

    i = self%index_of(lower_case(name))
    if (i == 0) then
      call self%add_entry(name, at, i)
      self%list(i)%domain = domain
      self%list(i)%comment = comment
      call self%use_setting(i, v, log)
      call check(v, domain, at, command, name, log, accepted)
    else
      if (self%list(i)%is_counter) then
        call log%add_error(at, command, quoted(name) // ' counts a LOOP', 'Choose another name.')
        return
      end if
      if (domain%is_given) self%list(i)%domain = domain
      call check(v, self%list(i)%domain, at, command, name, log, accepted)
    end if
    self%list(i)%v = v
  end subroutine assign

  subroutine use_setting(self, i, v, log)
    !! A setting of the command line takes the place of the default.
    class(deck_parameters), intent(inout) :: self
    integer, intent(in) :: i
    type(value), intent(inout) :: v         !! default, then what counts
    type(message_log), intent(inout) :: log
    type(expression_problem) :: problem
    type(value) :: given
    character(:), allocatable :: text, expected
    integer :: k
    logical :: accepted

    text = ''
    expected = ''
    do k = 1, size(self%settings)
      if (lower_case(self%settings(k)%name) /= self%list(i)%key) cycle
      self%used(k) = .true.
      if (v%kind == unknown_value) cycle
      text = trim(adjustl(self%settings(k)%text))
      if (v%kind == word_value) then
        given%kind = word_value
        given%word = text
        if (len(text) > 1) then
          if (text(1:1) == '"' .and. text(len(text):) == '"') given%word = text(2:len(text)-1)
        end if
      else
        call evaluate(text, self, given, problem)
        expected = 'expected a number for ' // self%list(i)%name // ', found ' // quoted(text)
        if (problem%found) then
          if (problem%name /= text) expected = expected // ': ' // problem%fact
          call log%add_error(command_line_place(), '', expected, 'The deck declares it at ' // &
            in_place(self%list(i)%at))
          cycle
        else if (given%kind == word_value) then
          call log%add_error(command_line_place(), '', expected, 'The deck declares it at ' // &
            in_place(self%list(i)%at))
          cycle
        end if
      end if
      call check(given, self%list(i)%domain, command_line_place(), '', self%list(i)%name, log, &
        accepted)
      if (.not. accepted) cycle
      v = given
      self%list(i)%is_set = .true.
    end do
  end subroutine use_setting

  pure integer function bracket_of(line)
    !! Where [ begins, outside quotes; len(line) + 1 if there is none.
    character(*), intent(in) :: line
    logical :: in_quotes

    in_quotes = .false.
    do bracket_of = 1, len(line)
      if (line(bracket_of:bracket_of) == '"') in_quotes = .not. in_quotes
      if (line(bracket_of:bracket_of) == '[' .and. .not. in_quotes) return
    end do
  end function bracket_of

  subroutine read_domain(self, text, v, domain, at, name, log)
    class(deck_parameters), intent(in) :: self
    character(*), intent(in) :: text        ! [ ... ]
    type(value), intent(in) :: v            ! the default decides whether the list holds words
    type(value_domain), intent(out) :: domain
    type(deck_place), intent(in) :: at
    character(*), intent(in) :: name
    type(message_log), intent(inout) :: log
    type(value), allocatable :: longer(:)
    type(value) :: choice
    character(:), allocatable :: item
    integer :: first, last, colon, n, k
    logical :: good

    good = .true.
    item = ''
    allocate (domain%choices(0))
    n = index(text, ']')
    if (n == 0) then
      call log%add_error(at, 'PARAmeter', name // ': "]" is missing', '')
      n = len(text) + 1
    else if (verify(text(n+1:), ' ') > 0) then
      call log%add_error(at, 'PARAmeter', name // ': ' // quoted(trim(adjustl(text(n+1:)))) // &
        ' is unexpected behind "]"', '')
    end if
    first = 2
    do
      k = verify(text(first:n-1), ' ,')
      if (k == 0) exit
      first = first + k - 1
      k = scan(text(first:n-1), ' ,')
      last = n - 1
      if (k > 0) last = first + k - 2
      item = text(first:last)
      first = last + 1
      colon = index(item, ':')
      if (lower_case(item) == 'integer' .and. v%kind /= word_value) then
        domain%is_integer = .true.
      else if (colon > 0 .and. v%kind /= word_value) then
        domain%has_range = .true.
        if (colon > 1) call bound(item(1:colon-1), domain%least)
        if (colon < len(item)) call bound(item(colon+1:), domain%most)
      else
        if (v%kind == word_value) then
          choice%kind = word_value
          choice%word = item
          if (len(item) > 1) then
            if (item(1:1) == '"' .and. item(len(item):) == '"') choice%word = item(2:len(item)-1)
          end if
        else
          choice%kind = number_value
          call bound(item, choice%x)
        end if
        allocate (longer(size(domain%choices)+1))
        do k = 1, size(domain%choices)
          longer(k) = domain%choices(k)
        end do
        longer(size(longer)) = choice
        call move_alloc(longer, domain%choices)
      end if
    end do
    domain%is_given = good

  contains

    subroutine bound(expression, x)
      character(*), intent(in) :: expression
      real(wp), intent(inout) :: x          ! stays after an error
      type(expression_problem) :: problem
      type(value) :: b

      call evaluate(expression, self, b, problem)
      if (problem%found) then
        good = .false.
        call log%add_error(at, 'PARAmeter', name // ': ' // problem%fact, problem%remedy)
      else if (b%kind == word_value) then
        good = .false.
        call log%add_error(at, 'PARAmeter', name // ': expected a number in [ ], found ' // &
          quoted(expression), '')
      else if (b%kind == number_value) then
        x = b%x
      else
        good = .false.
      end if
    end subroutine bound
  end subroutine read_domain

  subroutine check(v, domain, at, command, name, log, accepted)
    !! Is the value allowed? A word takes the spelling of the list; a refused one becomes unknown.
    type(value), intent(inout) :: v
    type(value_domain), intent(in) :: domain
    type(deck_place), intent(in) :: at
    character(*), intent(in) :: command, name
    type(message_log), intent(inout) :: log
    logical, intent(out) :: accepted
    integer :: k

    accepted = v%kind /= unknown_value
    if (.not. accepted .or. .not. domain%is_given) return
    if (v%kind == number_value) then
      if (domain%is_integer) accepted = equal(aint(v%x), v%x)
      if (domain%has_range) accepted = accepted .and. v%x >= domain%least .and. v%x <= domain%most
    end if
    if (size(domain%choices) > 0 .and. accepted) then
      accepted = .false.
      do k = 1, size(domain%choices)
        if (domain%choices(k)%kind /= v%kind) cycle
        if (v%kind == number_value) then
          accepted = equal(domain%choices(k)%x, v%x)
        else
          accepted = lower_case(domain%choices(k)%word) == lower_case(v%word)
          if (accepted) v%word = domain%choices(k)%word
        end if
        if (accepted) exit
      end do
    end if
    if (accepted) return
    call log%add_error(at, command, name // ' = ' // value_text(v) // ' is not allowed', &
      'Allowed: ' // domain_text(domain))
    v%kind = unknown_value
  end subroutine check

  function domain_text(domain) result(text)
    type(value_domain), intent(in) :: domain
    character(:), allocatable :: text
    integer :: k

    text = ''
    if (domain%has_range) then
      text = 'numbers'
      if (domain%is_integer) text = 'whole numbers'
      if (domain%least > -huge(1.0_wp)) text = text // ' from ' // write_number(domain%least)
      if (domain%most < huge(1.0_wp)) text = text // ' up to ' // write_number(domain%most)
    else if (domain%is_integer .and. size(domain%choices) == 0) then
      text = 'whole numbers'
    end if
    do k = 1, size(domain%choices)
      if (len(text) > 0) text = text // ', '
      text = text // value_text(domain%choices(k))
    end do
  end function domain_text

  subroutine add_entry(self, name, at, i)
    class(deck_parameters), intent(inout) :: self
    character(*), intent(in) :: name
    type(deck_place), intent(in) :: at
    integer, intent(out) :: i
    type(parameter_entry), allocatable :: longer(:)

    allocate (longer(size(self%list)+1))
    do i = 1, size(self%list)
      longer(i) = self%list(i)
    end do
    call move_alloc(longer, self%list)
    i = size(self%list)
    self%list(i)%name = name
    self%list(i)%key = lower_case(name)
    self%list(i)%comment = ''
    self%list(i)%at = at
  end subroutine add_entry

  subroutine set_counter(self, name, n, at, log)
    class(deck_parameters), intent(inout) :: self
    character(*), intent(in) :: name        !! of the counter of a LOOP
    integer, intent(in) :: n                !! its value
    type(deck_place), intent(in) :: at
    type(message_log), intent(inout) :: log
    integer :: i

    if (.not. is_name(name) .or. is_reserved(name)) then
      call log%add_error(at, 'LOOP', quoted(name) // ' cannot be the name of a counter', &
        'A name is a letter, then letters, digits and underscores.')
      return
    end if
    i = self%index_of(lower_case(name))
    if (i == 0) then
      call self%add_entry(name, at, i)
      self%list(i)%is_counter = .true.
    else if (.not. self%list(i)%is_counter) then
      call log%add_error(at, 'LOOP', quoted(name) // ' is a parameter and cannot count', &
        'Choose another name.')
      return
    end if
    self%list(i)%v%kind = number_value
    self%list(i)%v%x = n
  end subroutine set_counter

  subroutine begin_table(self, name, at, log)
    class(deck_parameters), intent(inout) :: self
    character(*), intent(in) :: name
    type(deck_place), intent(in) :: at
    type(message_log), intent(inout) :: log

    call self%tables%begin(name, self%index_of(lower_case(name)) > 0, at, log)
  end subroutine begin_table

  subroutine add_table_line(self, rec, log)
    class(deck_parameters), intent(inout) :: self
    type(record), intent(in) :: rec         !! column keys, or a row key and its values
    type(message_log), intent(inout) :: log

    call self%tables%add_line(rec, log)
  end subroutine add_table_line

  subroutine check_settings(self, log)
    !! At the end of the deck: refuses the settings that it never asked for.
    class(deck_parameters), intent(in) :: self
    type(message_log), intent(inout) :: log
    integer :: k, i

    do k = 1, size(self%settings)
      if (self%used(k)) cycle
      i = self%index_of(lower_case(self%settings(k)%name))
      if (i > 0) then
        call log%add_error(command_line_place(), '', quoted(self%settings(k)%name) // &
          ' counts a LOOP of the deck and cannot be set', '')
      else
        call log%add_error(command_line_place(), '', 'the deck has no parameter ' // &
          quoted(self%settings(k)%name), name_hint(self%settings(k)%name, self%names(), &
            'parameters'))
      end if
    end do
  end subroutine check_settings

  function names(self) result(list)
    class(deck_parameters), intent(in) :: self
    type(string), allocatable :: list(:)    !! what the command line can set
    integer :: i, n

    allocate (list(count(.not. self%list%is_counter)))
    n = 0
    do i = 1, size(self%list)
      if (self%list(i)%is_counter) cycle
      n = n + 1
      list(n)%s = self%list(i)%name
    end do
  end function names

  integer function index_of(self, key)
    class(deck_parameters), intent(in) :: self
    character(*), intent(in) :: key         ! in lower case

    do index_of = size(self%list), 1, -1
      if (self%list(index_of)%key == key) return
    end do
  end function index_of

  subroutine find_symbol(self, name, v, found)
    class(deck_parameters), intent(in) :: self
    character(*), intent(in) :: name        !! in lower case
    type(value), intent(out) :: v
    logical, intent(out) :: found
    integer :: i

    i = self%index_of(name)
    found = i > 0
    if (found) v = self%list(i)%v
  end subroutine find_symbol

  logical function has_table(self, name)
    class(deck_parameters), intent(in) :: self
    character(*), intent(in) :: name        !! in lower case

    has_table = self%tables%index_of(name) > 0
  end function has_table

  logical function has_key(self, table, column, key)
    class(deck_parameters), intent(in) :: self
    character(*), intent(in) :: table       !! in lower case
    logical, intent(in) :: column           !! a column key, else a row key
    character(*), intent(in) :: key         !! in lower case

    has_key = self%tables%has_key(table, column, key)
  end function has_key

  subroutine look_up(self, table, row, column, v, fact, remedy)
    class(deck_parameters), intent(in) :: self
    character(*), intent(in) :: table       !! in lower case
    character(*), intent(in) :: row, column !! keys, any case; column '': the only one
    type(value), intent(out) :: v
    character(:), allocatable, intent(out) :: fact, remedy

    call self%tables%look_up(table, row, column, v, fact, remedy)
  end subroutine look_up

  function symbol_hint(self, name) result(hint)
    class(deck_parameters), intent(in) :: self
    character(*), intent(in) :: name
    character(:), allocatable :: hint
    type(string), allocatable :: list(:)
    integer :: i

    allocate (list(size(self%list)))
    do i = 1, size(list)
      list(i)%s = self%list(i)%name
    end do
    hint = name_hint(name, list, 'parameters')
    deallocate (list)
    list = self%tables%names()
    if (size(list) == 0) return
    hint = hint // ' ' // known_names(list, 'tables')
  end function symbol_hint
end module parameters
