module deck_tables
  !! Tables of a deck: TABLe with a row of column keys, then rows of a key and values. A cell is found by the two keys,
  !! in any case.
  use messages, only: string, deck_place, message_log, known_names, lower_case, quoted
  use expressions, only: value, is_name, is_reserved
  use deck_record, only: record
  implicit none (type, external)
  private
  public :: table_list

  type :: table_entry
    character(:), allocatable :: name, key
    type(string), allocatable :: columns(:), rows(:)
    type(value), allocatable :: cells(:,:)  ! (columns, rows)
    logical :: has_header = .false.
    logical :: has_problem = .false.        ! reported when the table was read
  end type table_entry

  type :: table_list
    private
    type(table_entry), allocatable :: list(:)
  contains
    procedure :: start
    procedure :: begin => begin_table
    procedure :: add_line => add_table_line
    procedure :: index_of
    procedure :: has_key
    procedure :: look_up
    procedure :: names => table_names
  end type table_list

contains

  subroutine start(self)
    class(table_list), intent(inout) :: self

    allocate (self%list(0))
  end subroutine start

  subroutine begin_table(self, name, is_taken, at, log)
    class(table_list), intent(inout) :: self
    character(*), intent(in) :: name
    logical, intent(in) :: is_taken         !! by a parameter
    type(deck_place), intent(in) :: at
    type(message_log), intent(inout) :: log
    type(table_entry), allocatable :: longer(:)
    integer :: i

    allocate (longer(size(self%list)+1))
    do i = 1, size(self%list)
      longer(i) = self%list(i)
    end do
    if (self%index_of(lower_case(name)) > 0) call log%add_error(at, 'TABLe', &
      'the table ' // quoted(name) // ' is given twice', '')
    call move_alloc(longer, self%list)
    i = size(self%list)
    self%list(i)%name = name
    self%list(i)%key = lower_case(name)
    allocate (self%list(i)%columns(0), self%list(i)%rows(0), self%list(i)%cells(0,0))
    if (is_name(name) .and. .not. is_reserved(name) .and. &
      .not. is_taken) return
    self%list(i)%has_problem = .true.
    call log%add_error(at, 'TABLe', quoted(name) // ' cannot be the name of a table', &
      'A name is a letter, then letters, digits and underscores, and has no other meaning.')
  end subroutine begin_table

  subroutine add_table_line(self, rec, log)
    class(table_list), intent(inout) :: self
    type(record), intent(in) :: rec         !! column keys, or a row key and its values
    type(message_log), intent(inout) :: log
    type(string), allocatable :: rows(:)
    type(value), allocatable :: cells(:,:)
    type(value) :: v
    integer :: i, k, n

    associate (table => self%list(size(self%list)))
      if (.not. table%has_header) then
        table%has_header = .true.
        deallocate (table%columns, table%cells)
        allocate (table%columns(rec%count), table%cells(rec%count,0))
        do i = 1, rec%count
          table%columns(i)%s = rec%word(i)
        end do
        return
      end if
      n = size(table%columns)
      if (rec%count /= n + 1) then
        table%has_problem = .true.
        call rec%check_count(n + 1, n + 1, log, 'a row key and a value for each column')
        return
      end if
      do k = 1, size(table%rows)
        if (lower_case(table%rows(k)%s) == lower_case(rec%word(1))) then
          call rec%add_error(log, 'the row ' // quoted(rec%word(1)) // ' is given twice', '')
          return
        end if
      end do
      allocate (rows(size(table%rows)+1), cells(n,size(table%rows)+1))
      do k = 1, size(table%rows)
        rows(k)%s = table%rows(k)%s
        do i = 1, n
          cells(i,k) = table%cells(i,k)
        end do
      end do
      k = size(rows)
      rows(k)%s = rec%word(1)
      do i = 1, n
        call rec%item_value(i + 1, v, log, 'a number or a word in quotes', 'column ' // &
          table%columns(i)%s)
        cells(i,k) = v
      end do
      call move_alloc(rows, table%rows)
      call move_alloc(cells, table%cells)
    end associate
  end subroutine add_table_line

  integer function index_of(self, key)
    class(table_list), intent(in) :: self
    character(*), intent(in) :: key         ! in lower case

    do index_of = size(self%list), 1, -1
      if (self%list(index_of)%key == key) return
    end do
  end function index_of

  function table_names(self) result(list)
    class(table_list), intent(in) :: self
    type(string), allocatable :: list(:)    !! as the deck writes them
    integer :: i

    allocate (list(size(self%list)))
    do i = 1, size(list)
      list(i)%s = self%list(i)%name
    end do
  end function table_names

  logical function has_key(self, table, column, key)
    class(table_list), intent(in) :: self
    character(*), intent(in) :: table       !! in lower case
    logical, intent(in) :: column           !! a column key, else a row key
    character(*), intent(in) :: key         !! in lower case
    integer :: i

    i = self%index_of(table)
    if (column) then
      has_key = key_index(self%list(i)%columns, key) > 0
    else
      has_key = key_index(self%list(i)%rows, key) > 0
    end if
  end function has_key

  pure integer function key_index(keys, key)
    type(string), intent(in) :: keys(:)
    character(*), intent(in) :: key

    do key_index = size(keys), 1, -1
      if (lower_case(keys(key_index)%s) == lower_case(key)) return
    end do
  end function key_index

  subroutine look_up(self, table, row, column, v, fact, remedy)
    class(table_list), intent(in) :: self
    character(*), intent(in) :: table       !! in lower case
    character(*), intent(in) :: row, column !! keys, any case; column '': the only one
    type(value), intent(out) :: v
    character(:), allocatable, intent(out) :: fact, remedy
    integer :: i, j, k

    fact = ''
    remedy = ''
    i = self%index_of(table)
    if (self%list(i)%has_problem) return
    associate (t => self%list(i))
      k = key_index(t%rows, row)
      j = key_index(t%columns, column)
      if (len(column) == 0 .and. size(t%columns) == 1) j = 1
      if (k == 0) then
        fact = 'the table ' // quoted(t%name) // ' has no row ' // quoted(row)
        remedy = known_names(t%rows, 'rows')
      else if (len(column) == 0 .and. j == 0) then
        fact = 'the table ' // quoted(t%name) // ' needs a row and a column'
        remedy = known_names(t%columns, 'columns')
      else if (j == 0) then
        fact = 'the table ' // quoted(t%name) // ' has no column ' // quoted(column)
        remedy = known_names(t%columns, 'columns')
      else
        v = t%cells(j,k)
      end if
    end associate
  end subroutine look_up
end module deck_tables
