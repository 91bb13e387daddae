module extraction_set
  !! Compact store of elements: for each its parametric dimension, degrees, connectivity and
  !! extraction operator. Everything is ragged, an element costs what it needs; identical
  !! operators are stored once. Components are public for reading; writing goes through the
  !! procedures. The set must be a `target`, because operators and connectivities are handed out
  !! as pointers into it; they are valid until the next addition.
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use kinds, only: wp, i8
  use status_codes, only: ok, bad_extraction, node_out_of_range, not_finite
  implicit none (type, external)
  private
  public :: extraction_set_type

  type :: extraction_set_type
    integer :: ne = 0                           !! number of elements
    integer :: nop = 0                          !! number of different operators
    integer, allocatable :: dp(:)               !! parametric dimension (ne), 0..3
    integer, allocatable :: degree(:,:)         !! degrees (3,ne), 0 in unused directions
    integer, allocatable :: node_ptr(:)  !! element e has nodes(node_ptr(e):node_ptr(e+1)-1) (ne+1)
    integer, allocatable :: nodes(:)            !! connectivities, one after another
    integer, allocatable :: operator_of(:)      !! operator of each element (ne)
    integer, allocatable :: op_rows(:)          !! functions nen of each operator (nop)
    integer, allocatable :: op_columns(:)       !! Bernstein functions nb of each operator (nop)
    integer(i8), allocatable :: op_ptr(:)       !! operator o is coef(op_ptr(o):op_ptr(o+1)-1),
                                                !! (nen,nb) (nop+1)
    real(wp), allocatable :: coef(:)            !! coefficients, one operator after another
    integer(i8), allocatable, private :: hash(:)    !! of the bits of each operator (nop)
    integer, allocatable, private :: bucket(:)      !! open-addressed table of operators, a power
                                                    !! of two long
  contains
    procedure :: init
    procedure :: add_operator
    procedure :: add_element
    procedure :: add_element_with_operator
    procedure :: nen
    procedure :: nb
    procedure :: connectivity
    procedure :: operator => operator_of_element
    procedure :: check
    procedure :: finish
    procedure :: bytes
  end type extraction_set_type

contains

  subroutine init(self)
    !! Empties the set.
    class(extraction_set_type), intent(inout) :: self

    integer, parameter :: first_size = 16

    self%ne = 0
    self%nop = 0
    self%dp = spread(0, 1, first_size)
    self%degree = reshape(self%dp, [3, first_size], pad=[0])
    self%node_ptr = spread(1, 1, first_size + 1)
    self%nodes = self%dp
    self%operator_of = self%dp
    self%op_rows = self%dp
    self%op_columns = self%dp
    self%op_ptr = spread(1_i8, 1, first_size + 1)
    self%coef = spread(0.0_wp, 1, first_size)
    self%hash = spread(0_i8, 1, first_size)
    self%bucket = spread(0, 1, 4 * first_size)
  end subroutine init

  subroutine add_operator(self, ce, op)
    !! Stores an operator unless it is there, bit by bit (but for the sign of zeros).
    class(extraction_set_type), intent(inout) :: self
    real(wp), intent(in) :: ce(:,:)   !! operator (nen,nb)
    integer, intent(out) :: op        !! its number

    integer(i8) :: at, bits, code, last
    integer :: i, j, place

    if (.not. allocated(self%dp)) call self%init()
    at = self%op_ptr(self%nop+1)
    last = at + int(size(ce, 1), i8) * size(ce, 2) - 1
    if (last > size(self%coef, kind=i8)) call grow_real(self%coef, last)

    ! copied first, so that comparison runs over contiguous memory; forgotten when it was known
    code = ieor(int(size(ce, 1), i8), ishftc(int(size(ce, 2), i8), 32))
    do j = 1, size(ce, 2)
      do i = 1, size(ce, 1)
        bits = transfer(ce(i,j), bits)
        if (shiftl(bits, 1) == 0_i8) bits = 0_i8
        self%coef(at) = transfer(bits, 0.0_wp)
        code = mixed(ieor(code, bits))
        at = at + 1
      end do
    end do

    place = first_place(code, size(self%bucket))
    do while (self%bucket(place) /= 0)
      op = self%bucket(place)
      if (self%hash(op) == code) then
        if (same_as_last(self, op, size(ce, 1), size(ce, 2))) return
      end if
      place = 1 + iand(place, size(self%bucket) - 1)
    end do

    op = self%nop + 1
    if (op > size(self%op_rows)) then
      call grow(self%op_rows, op)
      call grow(self%op_columns, op)
      call grow_long(self%op_ptr, int(op, i8) + 1)
      call grow_long(self%hash, int(op, i8))
    end if
    self%nop = op
    self%op_rows(op) = size(ce, 1)
    self%op_columns(op) = size(ce, 2)
    self%op_ptr(op+1) = last + 1
    self%hash(op) = code
    self%bucket(place) = op
    if (2 * op > size(self%bucket)) call rebuild_buckets(self, 2 * size(self%bucket))
  end subroutine add_operator

  pure function same_as_last(self, op, rows, columns) result(same)
    class(extraction_set_type), intent(in) :: self
    integer, intent(in) :: op  !! operator to compare with the one just copied behind the last
    integer, intent(in) :: rows, columns   !! size of the latter
    logical :: same                        !! whether all bits agree

    integer(i8) :: k, shift

    same = .false.
    if (self%op_rows(op) /= rows .or. self%op_columns(op) /= columns) return
    shift = self%op_ptr(self%nop+1) - self%op_ptr(op)
    do k = self%op_ptr(op), self%op_ptr(op+1) - 1
      if (transfer(self%coef(k), 1_i8) /= transfer(self%coef(k+shift), 1_i8)) return
    end do
    same = .true.
  end function same_as_last

  subroutine add_element(self, dp, degree, nodes, ce, id)
    class(extraction_set_type), intent(inout) :: self
    integer, intent(in) :: dp          !! parametric dimension, 0..3
    integer, intent(in) :: degree(:)   !! degrees (at least dp)
    integer, intent(in) :: nodes(:)    !! connectivity (nen)
    real(wp), intent(in) :: ce(:,:)    !! extraction operator (nen,nb)
    integer, intent(out) :: id         !! number of the new element

    integer :: op

    call self%add_operator(ce, op)
    call self%add_element_with_operator(dp, degree, nodes, op, id)
  end subroutine add_element

  subroutine add_element_with_operator(self, dp, degree, nodes, op, id)
    class(extraction_set_type), intent(inout) :: self
    integer, intent(in) :: dp          !! parametric dimension, 0..3
    integer, intent(in) :: degree(:)   !! degrees (at least dp)
    integer, intent(in) :: nodes(:)    !! connectivity (nen)
    integer, intent(in) :: op          !! number from add_operator
    integer, intent(out) :: id         !! number of the new element

    integer :: first, last

    if (.not. allocated(self%dp)) call self%init()
    id = self%ne + 1
    if (id > size(self%dp)) then
      call grow(self%dp, id)
      call grow(self%operator_of, id)
      call grow(self%node_ptr, id + 1)
      call grow_columns(self%degree, id)
    end if
    first = self%node_ptr(id)
    if (size(nodes) > huge(first) - first) &
      error stop 'extraction_set: connectivities exceed the range of integers'
    last = first + size(nodes) - 1
    if (last > size(self%nodes)) call grow(self%nodes, last)

    self%ne = id
    self%dp(id) = dp
    self%degree(:,id) = 0
    self%degree(1:dp,id) = degree(1:dp)
    self%nodes(first:last) = nodes
    self%node_ptr(id+1) = last + 1
    self%operator_of(id) = op
  end subroutine add_element_with_operator

  pure integer function nen(self, e)
    class(extraction_set_type), intent(in) :: self
    integer, intent(in) :: e   !! element

    nen = self%node_ptr(e+1) - self%node_ptr(e)
  end function nen

  pure integer function nb(self, e)
    class(extraction_set_type), intent(in) :: self
    integer, intent(in) :: e   !! element

    nb = self%op_columns(self%operator_of(e))
  end function nb

  function connectivity(self, e) result(ix)
    class(extraction_set_type), intent(in), target :: self
    integer, intent(in) :: e                !! element
    integer, pointer, contiguous :: ix(:)   !! its nodes (nen)

    ix => self%nodes(self%node_ptr(e):self%node_ptr(e+1)-1)
  end function connectivity

  function operator_of_element(self, e) result(ce)
    class(extraction_set_type), intent(in), target :: self
    integer, intent(in) :: e                   !! element
    real(wp), pointer, contiguous :: ce(:,:)   !! its extraction operator (nen,nb)

    integer :: op

    op = self%operator_of(e)
    ce(1:self%op_rows(op),1:self%op_columns(op)) => self%coef(self%op_ptr(op):self%op_ptr(op+1)-1)
  end function operator_of_element

  pure subroutine check(self, number_of_nodes, status, element)
    !! Looks for the first element that does not hold together.
    class(extraction_set_type), intent(in) :: self
    integer, intent(in) :: number_of_nodes   !! connectivities must name 1..number_of_nodes
    integer, intent(out) :: status           !! ok, bad_extraction, node_out_of_range or not_finite
    integer, intent(out) :: element          !! the first bad element, 0 when there is none

    logical :: finite(self%nop)
    integer :: e, op, first, last

    do op = 1, self%nop
      finite(op) = all(ieee_is_finite(self%coef(self%op_ptr(op):self%op_ptr(op+1)-1)))
    end do

    do e = 1, self%ne
      element = e
      op = self%operator_of(e)
      first = self%node_ptr(e)
      last = self%node_ptr(e+1) - 1
      status = bad_extraction
      if (op < 1 .or. op > self%nop) return
      if (self%dp(e) < 0 .or. self%dp(e) > 3) return
      if (any(self%degree(:,e) < 0)) return
      if (last < first .or. self%op_rows(op) /= last - first + 1) return
      if (self%op_columns(op) /= product(self%degree(:,e) + 1)) return
      status = node_out_of_range
      if (any(self%nodes(first:last) < 1) .or. any(self%nodes(first:last) > number_of_nodes)) return
      status = not_finite
      if (.not. finite(op)) return
    end do
    status = ok
    element = 0
  end subroutine check

  subroutine finish(self)
    !! Gives back memory that was reserved for growth; more can still be added.
    class(extraction_set_type), intent(inout) :: self

    integer, allocatable :: degree(:,:)
    integer :: e

    if (.not. allocated(self%dp)) call self%init()
    allocate (degree(3,self%ne))
    do e = 1, self%ne
      degree(:,e) = self%degree(:,e)
    end do
    call move_alloc(degree, self%degree)
    call shrink(self%dp, self%ne)
    call shrink(self%operator_of, self%ne)
    call shrink(self%nodes, self%node_ptr(self%ne+1) - 1)
    call shrink(self%node_ptr, self%ne + 1)
    call shrink_real(self%coef, self%op_ptr(self%nop+1) - 1)
    call shrink(self%op_rows, self%nop)
    call shrink(self%op_columns, self%nop)
    self%op_ptr = self%op_ptr(1:self%nop+1)
    self%hash = self%hash(1:self%nop)
  end subroutine finish

  pure integer(i8) function bytes(self)
    !! Memory of the set.
    class(extraction_set_type), intent(in) :: self

    integer(i8), parameter :: byte = 8

    bytes = 0
    if (.not. allocated(self%dp)) return
    bytes = storage_size(self%nodes) / byte * (size(self%dp, kind=i8) + size(self%degree, kind=i8) &
      + size(self%node_ptr, kind=i8) + size(self%nodes, kind=i8) + size(self%operator_of, kind=i8) &
      + size(self%op_rows, kind=i8) + size(self%op_columns, kind=i8) + size(self%bucket, kind=i8)) &
      + storage_size(self%coef) / byte * size(self%coef, kind=i8) &
      + storage_size(self%op_ptr) / byte * (size(self%op_ptr, kind=i8) + size(self%hash, kind=i8))
  end function bytes

  pure integer(i8) function mixed(code)
    !! Scrambles bits by shifts alone (xorshift of Marsaglia), as integer products may overflow.
    integer(i8), intent(in) :: code   !! bits

    mixed = ieor(code, shiftl(code, 13))
    mixed = ieor(mixed, shiftr(mixed, 7))
    mixed = ieor(mixed, shiftl(mixed, 17))
  end function mixed

  pure integer function first_place(code, table_size)
    integer(i8), intent(in) :: code       !! hash of an operator
    integer, intent(in) :: table_size     !! a power of two

    first_place = 1 + int(iand(ieor(code, shiftr(code, 32)), int(table_size - 1, i8)))
  end function first_place

  pure subroutine rebuild_buckets(self, table_size)
    class(extraction_set_type), intent(inout) :: self
    integer, intent(in) :: table_size   !! a power of two

    integer :: op, place

    self%bucket = spread(0, 1, table_size)
    do op = 1, self%nop
      place = first_place(self%hash(op), table_size)
      do while (self%bucket(place) /= 0)
        place = 1 + iand(place, table_size - 1)
      end do
      self%bucket(place) = op
    end do
  end subroutine rebuild_buckets

  pure subroutine grow(array, needed)
    integer, allocatable, intent(inout) :: array(:)   !! keeps its content
    integer, intent(in) :: needed                     !! least new size; at least doubled

    integer, allocatable :: larger(:)

    allocate (larger(max(needed, 2 * size(array))), source=0)
    larger(1:size(array)) = array
    call move_alloc(larger, array)
  end subroutine grow

  pure subroutine grow_columns(array, needed)
    integer, allocatable, intent(inout) :: array(:,:)   !! keeps its content
    integer, intent(in) :: needed  !! least new number of columns; at least doubled

    integer, allocatable :: larger(:,:)

    allocate (larger(size(array, 1),max(needed, 2 * size(array, 2))), source=0)
    larger(:,1:size(array, 2)) = array
    call move_alloc(larger, array)
  end subroutine grow_columns

  pure subroutine grow_long(array, needed)
    integer(i8), allocatable, intent(inout) :: array(:)   !! keeps its content
    integer(i8), intent(in) :: needed                     !! least new size; at least doubled

    integer(i8), allocatable :: larger(:)

    allocate (larger(max(needed, 2 * size(array, kind=i8))), source=0_i8)
    larger(1:size(array)) = array
    call move_alloc(larger, array)
  end subroutine grow_long

  pure subroutine grow_real(array, needed)
    real(wp), allocatable, intent(inout) :: array(:)   !! keeps its content
    integer(i8), intent(in) :: needed                  !! least new size; at least doubled

    real(wp), allocatable :: larger(:)

    allocate (larger(max(needed, 2 * size(array, kind=i8))), source=0.0_wp)
    larger(1:size(array)) = array
    call move_alloc(larger, array)
  end subroutine grow_real

  ! Not `array = array(1:n)`: its temporary may be larger than the stack.

  pure subroutine shrink(array, n)
    integer, allocatable, intent(inout) :: array(:)    !! keeps its first n items
    integer, intent(in) :: n

    integer, allocatable :: smaller(:)
    integer :: i

    allocate (smaller(n))
    do i = 1, n
      smaller(i) = array(i)
    end do
    call move_alloc(smaller, array)
  end subroutine shrink

  pure subroutine shrink_real(array, n)
    real(wp), allocatable, intent(inout) :: array(:)   !! keeps its first n items
    integer(i8), intent(in) :: n

    real(wp), allocatable :: smaller(:)
    integer(i8) :: i

    allocate (smaller(n))
    do i = 1, n
      smaller(i) = array(i)
    end do
    call move_alloc(smaller, array)
  end subroutine shrink_real
end module extraction_set
