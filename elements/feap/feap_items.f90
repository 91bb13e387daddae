module feap_items
  !! Items of a record of FEAP's deck: separated by blanks, commas or `=`, `!` begins a comment, names may stand in
  !! quotes, a record that ends with `&` goes on in the next one. Numbers keep all their digits.
  use kinds, only: wp
  use number_text, only: read_number
  use feap_host, only: record_length, next_record, expression, fail
  implicit none (type, external)
  private
  public :: item_list, split_record, read_items

  type :: item_list
    integer :: n = 0                         !! items
    character(:), allocatable :: line        !! the record
    integer, allocatable :: first(:), last(:) !! where each stands (n)
  contains
    procedure :: text
    procedure :: key
    procedure :: is_number
    procedure :: number
    procedure :: whole
    procedure :: find
    procedure :: integers_after
    procedure :: rest
  end type item_list

contains

  subroutine read_items(items)
    !! The next record; no items: the data set ends. A record with nothing but a comment does not end it.
    type(item_list), intent(out) :: items
    character(record_length) :: line

    do
      call next_record(line)
      call split_record(line, items)
      if (items%n > 0 .or. line == '') exit
    end do
  end subroutine read_items

  subroutine split_record(first_line, items)
    character(*), intent(in) :: first_line
    type(item_list), intent(out) :: items
    character(record_length) :: more
    integer :: i, n
    logical :: quoted, inside

    items%line = without_comment(first_line)
    do
      n = len_trim(items%line)
      if (n == 0) exit
      if (items%line(n:n) /= '&') exit
      call next_record(more)
      items%line = items%line(1:n - 1)//' '//without_comment(more)
    end do
    allocate (items%first(len(items%line)), items%last(len(items%line)))
    quoted = .false.
    inside = .false.
    do i = 1, len(items%line)
      if (items%line(i:i) == '"') then
        quoted = .not. quoted
        if (quoted) call begin_item(i + 1)
        if (.not. quoted) inside = .false.
      else if (quoted) then
        items%last(items%n) = i
      else if (scan(items%line(i:i), ' ,='//achar(9)//achar(13)) > 0) then
        inside = .false.
      else
        if (.not. inside) call begin_item(i)
        items%last(items%n) = i
      end if
    end do

  contains

    subroutine begin_item(at)
      integer, intent(in) :: at

      items%n = items%n + 1
      items%first(items%n) = at
      items%last(items%n) = at - 1
      inside = .true.
    end subroutine begin_item
  end subroutine split_record

  pure function without_comment(line) result(text)
    character(*), intent(in) :: line
    character(:), allocatable :: text
    integer :: i

    i = index(line, '!')
    if (i == 0) i = len(line) + 1
    text = trim(line(1:i - 1))
  end function without_comment

  pure function text(self, i)
    class(item_list), intent(in) :: self
    integer, intent(in) :: i                 !! item
    character(:), allocatable :: text        !! '' beyond the last

    text = ''
    if (i >= 1 .and. i <= self%n) text = self%line(self%first(i):self%last(i))
  end function text

  pure function key(self, i)
    class(item_list), intent(in) :: self
    integer, intent(in) :: i                 !! item
    character(4) :: key                      !! its first four letters, lower case
    integer :: k

    key = self%text(i)
    do k = 1, 4
      if (key(k:k) >= 'A' .and. key(k:k) <= 'Z') key(k:k) = achar(iachar(key(k:k)) + 32)
    end do
  end function key

  pure logical function is_number(self, i)
    !! Whether it begins as a number does.
    class(item_list), intent(in) :: self
    integer, intent(in) :: i
    character(:), allocatable :: item
    real(wp) :: value
    integer :: used

    item = self%text(i)
    call read_number(item, value, used)
    is_number = used > 0
  end function is_number

  function number(self, i)
    !! A number, or one of FEAP's expressions.
    class(item_list), intent(in) :: self
    integer, intent(in) :: i
    real(wp) :: number
    character(:), allocatable :: item
    integer :: used

    item = self%text(i)
    call read_number(item, number, used)
    if (used /= len(item) .or. used == 0) number = expression(item)
  end function number

  integer function whole(self, i)
    class(item_list), intent(in) :: self
    integer, intent(in) :: i
    real(wp) :: value

    value = self%number(i)
    whole = nint(value)
    if (abs(value - whole) > 1.0e-9_wp) call fail('a whole number is expected in place of '//self%text(i)//' in: '//self%line)
  end function whole

  pure integer function find(self, word)
    class(item_list), intent(in) :: self
    character(4), intent(in) :: word         !! lower case
    integer :: i

    find = 0                                 ! place of the item after the word
    do i = 1, self%n
      if (self%key(i) /= word) cycle
      find = i + 1
      return
    end do
  end function find

  subroutine integers_after(self, word, list)
    !! The whole numbers that follow a word.
    class(item_list), intent(in) :: self
    character(4), intent(in) :: word
    integer, allocatable, intent(out) :: list(:)
    integer :: first, last, i

    first = self%find(word)
    last = first
    if (first == 0) last = -1
    do while (last >= first .and. last <= self%n)
      if (.not. self%is_number(last)) exit
      last = last + 1
    end do
    allocate (list(max(0, last - first)))
    do i = 1, size(list)
      list(i) = self%whole(first + i - 1)
    end do
  end subroutine integers_after

  subroutine rest(self, first, values)
    !! All items from one on as numbers.
    class(item_list), intent(in) :: self
    integer, intent(in) :: first
    real(wp), allocatable, intent(out) :: values(:)
    integer :: i

    allocate (values(max(0, self%n - first + 1)))
    do i = 1, size(values)
      values(i) = self%number(first + i - 1)
    end do
  end subroutine rest
end module feap_items
