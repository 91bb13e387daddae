module linear_relations
  !! Linear relations between control values, sum c_k u_k = 0, brought one after the other into the form of LINKs: in
  !! each, one free value depends on others that depend on nothing. Relations that follow from what is there already
  !! vanish; those that contradict it are told.
  use kinds, only: wp
  use model_data, only: model_type, linear_constraint
  implicit none (type, external)
  private
  public :: relation_set

  type :: relation_set
    integer, allocatable, private :: which(:, :)             !! link of each value (ndf,nn), 0: none
    type(linear_constraint), allocatable, private :: links(:)
    integer, private :: n = 0
  contains
    procedure :: start
    procedure :: add
    procedure :: finish
  end type relation_set

  real(wp), parameter :: negligible = 1e-10_wp               !! of a relation's largest coefficient

contains

  subroutine start(self, model)
    !! With the links of the deck.
    class(relation_set), intent(inout) :: self
    type(model_type), intent(in) :: model
    integer :: l

    allocate (self%which(model%ndf, model%nn), source=0)
    self%n = 0
    if (allocated(model%links)) self%n = size(model%links)
    allocate (self%links(2*self%n + 64))
    do l = 1, self%n
      self%links(l) = model%links(l)
      self%which(model%links(l)%comp, model%links(l)%node) = l
    end do
  end subroutine start

  subroutine add(self, model, nodes, comps, coefs, place, contradicts)
    !! sum_k coefs(k) u(comps(k),nodes(k)) = 0. Of free values that may depend, one of the largest coefficient is taken,
    !! the first of them. A value that nothing is left to depend on is fixed.
    class(relation_set), intent(inout) :: self
    type(model_type), intent(inout) :: model
    integer, intent(in) :: nodes(:), comps(:)
    real(wp), intent(in) :: coefs(:)
    character(*), intent(in) :: place                   !! file:line
    logical, intent(out) :: contradicts                 !! what is prescribed does not fulfil the relation
    type(linear_constraint) :: new
    integer, allocatable :: node(:), comp(:)
    real(wp), allocatable :: coef(:)
    real(wp) :: constant, largest, prescribed
    integer :: i, k, m, pivot

    contradicts = .false.
    allocate (node(0), comp(0), coef(0))
    constant = 0
    largest = maxval(abs(coefs))
    do k = 1, size(nodes)
      i = self%which(comps(k), nodes(k))
      if (i == 0) then
        call gather(nodes(k), comps(k), coefs(k))
      else
        constant = constant + coefs(k)*self%links(i)%constant
        do m = 1, size(self%links(i)%nodes)
          call gather(self%links(i)%nodes(m), self%links(i)%comps(m), coefs(k)*self%links(i)%coefs(m))
        end do
      end if
    end do
    pivot = 0
    prescribed = 0
    do k = 1, size(node)
      if (abs(coef(k)) <= negligible*largest) cycle
      if (model%fixed(comp(k), node(k))) then
        prescribed = prescribed + coef(k)*model%disp(comp(k), node(k))
      else if (pivot == 0) then
        pivot = k
      else if (abs(coef(k)) > abs(coef(pivot))*(1 + negligible)) then
        pivot = k
      end if
    end do
    if (pivot == 0) then
      contradicts = abs(prescribed + constant) > negligible*largest*maxval(abs(model%disp))
      return
    end if
    new%node = node(pivot)
    new%comp = comp(pivot)
    new%constant = -constant/coef(pivot)
    new%place = place
    allocate (new%nodes(0), new%comps(0), new%coefs(0))
    do k = 1, size(node)
      if (k == pivot .or. abs(coef(k)) <= negligible*largest) cycle
      if (model%fixed(comp(k), node(k)) .and. .not. abs(model%disp(comp(k), node(k))) > 0) cycle
      new%nodes = [new%nodes, node(k)]
      new%comps = [new%comps, comp(k)]
      new%coefs = [new%coefs, -coef(k)/coef(pivot)]
    end do
    if (size(new%nodes) == 0 .and. .not. abs(new%constant) > 0) then
      model%fixed(new%comp, new%node) = .true.
      model%disp(new%comp, new%node) = 0
    else
      call append(self, new)
    end if

  contains

    subroutine gather(n, c, x)
      integer, intent(in) :: n, c
      real(wp), intent(in) :: x
      integer :: j

      do j = 1, size(node)
        if (node(j) /= n .or. comp(j) /= c) cycle
        coef(j) = coef(j) + x
        return
      end do
      node = [node, n]
      comp = [comp, c]
      coef = [coef, x]
    end subroutine gather
  end subroutine add

  subroutine append(self, new)
    !! Keep a link; links that depend on its value depend on what it depends on from now on.
    class(relation_set), intent(inout) :: self
    type(linear_constraint), intent(in) :: new
    type(linear_constraint), allocatable :: larger(:)
    integer :: i, l
    real(wp) :: c

    do l = 1, self%n
      do i = 1, size(self%links(l)%nodes)
        if (self%links(l)%nodes(i) /= new%node .or. self%links(l)%comps(i) /= new%comp) cycle
        associate (link => self%links(l))
          c = link%coefs(i)
          link%constant = link%constant + c*new%constant
          link%coefs = [link%coefs(:i - 1), link%coefs(i + 1:), c*new%coefs]
          link%nodes = [link%nodes(:i - 1), link%nodes(i + 1:), new%nodes]
          link%comps = [link%comps(:i - 1), link%comps(i + 1:), new%comps]
        end associate
        exit
      end do
    end do
    if (self%n == size(self%links)) then
      allocate (larger(2*self%n))
      do l = 1, self%n
        larger(l) = self%links(l)
      end do
      call move_alloc(larger, self%links)
    end if
    self%n = self%n + 1
    self%links(self%n) = new
    self%which(new%comp, new%node) = self%n
  end subroutine append

  subroutine finish(self, model)
    !! Put the links into the model.
    class(relation_set), intent(inout) :: self
    type(model_type), intent(inout) :: model
    type(linear_constraint), allocatable :: links(:)
    integer :: l

    allocate (links(self%n))
    do l = 1, self%n
      links(l) = self%links(l)
    end do
    call move_alloc(links, model%links)
  end subroutine finish
end module linear_relations
