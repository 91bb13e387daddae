module messages
  !! What is wrong with a deck or a command line, collected and shown at once.
  !!
  !! A message is place, fact, remedy:
  !!
  !!     hertz.inp:42: CONTact: slave surface "TOP" has no elements. Known surfaces: BASE, PUNCH.
  !!
  !! A `message_log` is passed to whoever may find an error; nobody stops at the first one. The log
  !! shows its messages in the order of the deck and once each (a line that a LOOP repeats is
  !! reported once). `name_hint` writes the remedy for a name that is not known: what was probably
  !! meant, and what there is.
  !!
  !!     type(message_log) :: log
  !!     call log%add_error(at, 'CONTact', 'slave surface "TOP" has no elements', &
  !!       name_hint('TOP', names, 'surfaces'))
  !!     if (log%error_count() > 0) then; call log%show(error_unit); stop 2; end if
  implicit none (type, external)
  private
  public :: string, deck_place, message_log
  public :: name_hint, known_names, closest_name, edit_distance, lower_case, quoted, in_place, &
    whole_text

  integer, parameter :: most_kept = 2000    !! messages that the log keeps; the rest is counted
  integer, parameter :: most_shown = 50     !! messages that `show` prints unless told otherwise
  integer, parameter :: most_names = 30     !! names that a hint lists

  type :: string
    !! An element of a list of names of different lengths.
    character(:), allocatable :: s
  end type string

  type :: deck_place
    !! Where something stands.
    character(:), allocatable :: file   !! as the user would open it, or 'command line'
    integer :: line = 0                 !! from 1; 0: the file as a whole
    integer :: order = 0                !! position in the order of reading; sorts messages
  end type deck_place

  type :: message
    integer :: order = 0
    logical :: is_error = .true.
    character(:), allocatable :: text
  end type message

  type :: message_log
    private
    type(message), allocatable :: list(:)
    integer :: kept = 0
    integer :: errors = 0
    integer :: warnings = 0
  contains
    procedure :: add_error
    procedure :: add_warning
    procedure :: error_count
    procedure :: warning_count
    procedure :: message_count
    procedure :: message_text
    procedure :: mentions
    procedure :: show
    procedure, private :: add
    procedure, private :: deck_order
  end type message_log

  interface name_hint
    module procedure name_hint_strings, name_hint_names
  end interface name_hint

  interface known_names
    module procedure known_names_strings, known_names_names
  end interface known_names

contains

  subroutine add_error(self, at, command, fact, remedy)
    class(message_log), intent(inout) :: self
    type(deck_place), intent(in) :: at       !! where
    character(*), intent(in) :: command      !! as it is shown (CONTact); '' if there is none
    character(*), intent(in) :: fact         !! what is wrong, without final full stop
    character(*), intent(in) :: remedy       !! what to do or what is known; may be ''

    call self%add(at, command, fact, remedy, .true.)
  end subroutine add_error

  subroutine add_warning(self, at, command, fact, remedy)
    class(message_log), intent(inout) :: self
    type(deck_place), intent(in) :: at       !! where
    character(*), intent(in) :: command      !! as it is shown (CONTact); '' if there is none
    character(*), intent(in) :: fact         !! what is doubtful, without final full stop
    character(*), intent(in) :: remedy       !! what to do; may be ''

    call self%add(at, command, fact, remedy, .false.)
  end subroutine add_warning

  pure integer function error_count(self)
    class(message_log), intent(in) :: self
    error_count = self%errors
  end function error_count

  pure integer function warning_count(self)
    class(message_log), intent(in) :: self
    warning_count = self%warnings
  end function warning_count

  pure integer function message_count(self)
    !! Messages that `message_text` can give, errors and warnings.
    class(message_log), intent(in) :: self
    message_count = self%kept
  end function message_count

  function message_text(self, i) result(text)
    class(message_log), intent(in) :: self
    integer, intent(in) :: i               !! 1 is the first in deck order
    character(:), allocatable :: text      !! the message; '' beyond the last
    integer :: order(self%kept)

    text = ''
    if (i < 1 .or. i > self%kept) return
    order = self%deck_order()
    text = self%list(order(i))%text
  end function message_text

  pure logical function mentions(self, fragment)
    !! Does any message hold this text? For tests of error paths.
    class(message_log), intent(in) :: self
    character(*), intent(in) :: fragment
    integer :: i

    mentions = .false.
    do i = 1, self%kept
      mentions = index(self%list(i)%text, fragment) > 0
      if (mentions) return
    end do
  end function mentions

  subroutine show(self, unit, most)
    class(message_log), intent(in) :: self
    integer, intent(in) :: unit              !! where to print
    integer, intent(in), optional :: most    !! messages at most (50)
    integer :: order(self%kept), i, shown, total

    shown = most_shown
    if (present(most)) shown = most
    shown = min(shown, self%kept)
    order = self%deck_order()
    do i = 1, shown
      write (unit, '(a)') self%list(order(i))%text
    end do
    total = self%errors + self%warnings
    if (total > shown) write (unit, '(a,i0,a,i0,a)') '... and ', total - shown, ' more (', &
      self%errors, ' errors in all).'
  end subroutine show

  subroutine add(self, at, command, fact, remedy, is_error)
    class(message_log), intent(inout) :: self
    type(deck_place), intent(in) :: at
    character(*), intent(in) :: command, fact, remedy
    logical, intent(in) :: is_error
    type(message), allocatable :: larger(:)
    character(:), allocatable :: text
    integer :: i

    text = in_place(at)
    if (len(text) > 0) text = text // ': '
    if (.not. is_error) text = text // 'warning: '
    if (len(command) > 0) text = text // command // ': '
    text = text // sentence(fact)
    if (len(remedy) > 0) text = text // ' ' // sentence(remedy)
    do i = self%kept, 1, -1
      if (self%list(i)%text == text) return
    end do

    if (is_error) then
      self%errors = self%errors + 1
    else
      self%warnings = self%warnings + 1
    end if
    if (self%kept == most_kept) return
    if (.not. allocated(self%list)) allocate (self%list(8))
    if (self%kept == size(self%list)) then
      allocate (larger(2*self%kept))
      do i = 1, self%kept
        larger(i)%order = self%list(i)%order
        larger(i)%is_error = self%list(i)%is_error
        call move_alloc(self%list(i)%text, larger(i)%text)
      end do
      call move_alloc(larger, self%list)
    end if
    self%kept = self%kept + 1
    self%list(self%kept)%order = at%order
    self%list(self%kept)%is_error = is_error
    call move_alloc(text, self%list(self%kept)%text)
  end subroutine add

  pure function deck_order(self) result(order)
    !! Insertion sort: stable, and the messages come nearly sorted.
    class(message_log), intent(in) :: self
    integer :: order(self%kept)
    integer :: i, j

    do i = 1, self%kept
      j = i
      do while (j > 1)
        if (self%list(order(j-1))%order <= self%list(i)%order) exit
        order(j) = order(j-1)
        j = j - 1
      end do
      order(j) = i
    end do
  end function deck_order

  pure function in_place(at) result(text)
    type(deck_place), intent(in) :: at
    character(:), allocatable :: text     !! file:line, or file, or ''

    text = ''
    if (allocated(at%file)) text = at%file
    if (at%line > 0) text = text // ':' // whole_text(at%line)
  end function in_place

  pure function whole_text(i) result(text)
    integer, intent(in) :: i
    character(:), allocatable :: text     !! the digits of i
    character(12) :: buffer

    write (buffer, '(i0)') i
    text = trim(buffer)
  end function whole_text

  pure function sentence(words) result(text)
    !! Ends with a full stop unless it ends already.
    character(*), intent(in) :: words
    character(:), allocatable :: text

    text = trim(words)
    if (len(text) == 0) return
    if (scan(text(len(text):), '.?!:') == 0) text = text // '.'
  end function sentence

  function name_hint_strings(name, names, kind) result(hint)
    character(*), intent(in) :: name          !! what the user wrote
    type(string), intent(in) :: names(:)      !! what there is
    character(*), intent(in) :: kind          !! plural, lower case: 'surfaces'
    character(:), allocatable :: hint         !! Did you mean "TOP"? Known surfaces: TOP, BASE.
    integer :: i

    i = closest_name(name, names)
    hint = known_names(names, kind)
    if (i > 0) hint = 'Did you mean "' // names(i)%s // '"? ' // hint
  end function name_hint_strings

  function name_hint_names(name, names, kind) result(hint)
    character(*), intent(in) :: name          !! what the user wrote
    character(*), intent(in) :: names(:)      !! what there is, blanks at the end ignored
    character(*), intent(in) :: kind          !! plural, lower case: 'surfaces'
    character(:), allocatable :: hint         !! Did you mean "TOP"? Known surfaces: TOP, BASE.

    hint = name_hint_strings(name, as_strings(names), kind)
  end function name_hint_names

  function known_names_strings(names, kind) result(text)
    type(string), intent(in) :: names(:)      !! what there is
    character(*), intent(in) :: kind          !! plural, lower case: 'surfaces'
    character(:), allocatable :: text         !! Known surfaces: TOP, BASE.
    integer :: i

    if (size(names) == 0) then
      text = 'There are no ' // kind // '.'
      return
    end if
    text = 'Known ' // kind // ': ' // names(1)%s
    do i = 2, min(size(names), most_names)
      text = text // ', ' // names(i)%s
    end do
    if (size(names) > most_names) text = text // ' and ' // &
      whole_text(size(names) - most_names) // ' more'
    text = text // '.'
  end function known_names_strings

  function known_names_names(names, kind) result(text)
    character(*), intent(in) :: names(:)      !! what there is, blanks at the end ignored
    character(*), intent(in) :: kind          !! plural, lower case: 'surfaces'
    character(:), allocatable :: text         !! Known surfaces: TOP, BASE.

    text = known_names_strings(as_strings(names), kind)
  end function known_names_names

  function as_strings(names) result(list)
    character(*), intent(in) :: names(:)
    type(string) :: list(size(names))
    integer :: i

    do i = 1, size(names)
      list(i)%s = trim(names(i))
    end do
  end function as_strings

  pure integer function closest_name(name, names)
    !! Index of the name that was probably meant; 0 if none is near enough (a third of the letters
    !! may differ).
    character(*), intent(in) :: name          !! what the user wrote
    type(string), intent(in) :: names(:)      !! what there is
    integer :: i, distance, nearest

    closest_name = 0
    if (len(name) > 64) return
    nearest = min(max(1, (len(name) + 2)/3), len(name) - 1) + 1
    do i = 1, size(names)
      if (abs(len(names(i)%s) - len(name)) >= nearest) cycle
      distance = edit_distance(lower_case(name), lower_case(names(i)%s))
      if (distance < nearest) then
        nearest = distance
        closest_name = i
      end if
    end do
  end function closest_name

  pure integer function edit_distance(a, b)
    !! Fewest insertions, deletions, substitutions and swaps of neighbours that turn a into b.
    character(*), intent(in) :: a, b
    integer :: d(-1:len(a),-1:len(b)), i, j, change

    do i = 0, len(a)
      d(i,0) = i
    end do
    do j = 0, len(b)
      d(0,j) = j
    end do
    do j = 1, len(b)
      do i = 1, len(a)
        change = merge(0, 1, a(i:i) == b(j:j))
        d(i,j) = min(d(i-1,j) + 1, d(i,j-1) + 1, d(i-1,j-1) + change)
        if (i > 1 .and. j > 1) then
          if (a(i:i) == b(j-1:j-1) .and. a(i-1:i-1) == b(j:j)) d(i,j) = min(d(i,j), d(i-2,j-2) + 1)
        end if
      end do
    end do
    edit_distance = d(len(a),len(b))
  end function edit_distance

  pure function lower_case(text) result(lower)
    character(*), intent(in) :: text
    character(len(text)) :: lower
    integer :: i

    lower = text
    do i = 1, len(text)
      if (text(i:i) >= 'A' .and. text(i:i) <= 'Z') lower(i:i) = achar(iachar(text(i:i)) + 32)
    end do
  end function lower_case

  pure function quoted(text) result(q)
    !! In quotes, shortened to what a message can show.
    character(*), intent(in) :: text
    character(:), allocatable :: q
    integer, parameter :: longest = 60

    if (len(text) > longest) then
      q = '"' // text(1:longest) // '..."'
    else
      q = '"' // text // '"'
    end if
  end function quoted
end module messages
